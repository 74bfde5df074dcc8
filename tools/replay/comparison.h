#pragma once

// Two runs compared message by message and field by field, to the bit: what was recorded against what a replay gave.
// A message finds its like by the sequence number (TORQUE and CONTROLLER_STATE: of the ENCODER they answer). A message
// that only one of the runs has is counted, not compared.

#include <cstdint>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "msgs/messages.h"
#include "msgs/run_stream.h"
#include "tools/replay/message_fields.h"

namespace slewlab::tools {

struct FieldDifference {
  std::string channel;
  std::string field;                 // with index: motor_torque[0]
  std::string unit;
  std::int64_t count = 0;            // messages in which it differs
  double largest = 0.0;              // size; infinite where one of the two is no number
  std::int64_t largest_time = 0;     // [ns]
  std::int64_t first_time = 0;       // [ns]
  std::int64_t first_key = 0;        // sequence number
  double first_recorded = 0.0;
  double first_replayed = 0.0;
};

struct ChannelComparison {
  std::string channel;
  std::int64_t compared = 0;       // messages
  std::int64_t first_time = 0, last_time = 0;  // [ns] of the compared
  std::int64_t differing = 0;      // of these
  std::int64_t only_recorded = 0;
  std::int64_t only_replayed = 0;
  std::vector<FieldDifference> differences;  // in the order of the message's fields
};

// The recorded messages of a channel beside those that a replay gives, one by one as they come.
template <class Message>
class RunningComparison {
 public:
  explicit RunningComparison(const msgs::RunStream& record) : recorded_(record) {
    result_.channel = msgs::wire_messages()[msgs::channel_of<Message>()].channel;
  }
  void add(const Message& replayed);  // keys rise
  ChannelComparison finish();         // behind the last

 private:
  msgs::MessageReader<Message> recorded_;
  std::vector<FieldValue> fields_;
  ChannelComparison result_;
};

// The earliest of all; of several at one instant the first in the order given. nullptr where nothing differs.
const FieldDifference* first_difference(const std::vector<ChannelComparison>& channels);

bool identical(const std::vector<ChannelComparison>& channels);
std::int64_t compared_messages(const std::vector<ChannelComparison>& channels);

// "from 0.000 s to 59.990 s", of which channels many messages could not be compared, and of which nothing, as people read it; empty where that is all of them.
std::string compared_span(const std::vector<ChannelComparison>& channels);

// One line per channel; then, where something differs, the first difference and a table of the fields.
void print(std::ostream& out, const std::vector<ChannelComparison>& channels);

}  // namespace slewlab::tools
