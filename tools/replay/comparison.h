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
  std::int64_t differing = 0;      // of these
  std::int64_t only_recorded = 0;
  std::int64_t only_replayed = 0;
  std::vector<FieldDifference> differences;  // in the order of the message's fields
};

ChannelComparison compare(const std::vector<msgs::Encoder>& recorded, const std::vector<msgs::Encoder>& replayed);
ChannelComparison compare(const std::vector<msgs::Sensors>& recorded, const std::vector<msgs::Sensors>& replayed);
ChannelComparison compare(const std::vector<msgs::Truth>& recorded, const std::vector<msgs::Truth>& replayed);
ChannelComparison compare(const std::vector<msgs::PlantStatus>& recorded,
                          const std::vector<msgs::PlantStatus>& replayed);
ChannelComparison compare(const std::vector<msgs::Torque>& recorded, const std::vector<msgs::Torque>& replayed);
ChannelComparison compare(const std::vector<msgs::ControllerState>& recorded,
                          const std::vector<msgs::ControllerState>& replayed);

// The earliest of all; of several at one instant the first in the order given. nullptr where nothing differs.
const FieldDifference* first_difference(const std::vector<ChannelComparison>& channels);

bool identical(const std::vector<ChannelComparison>& channels);
std::int64_t compared_messages(const std::vector<ChannelComparison>& channels);

// One line per channel; then, where something differs, the first difference and a table of the fields.
void print(std::ostream& out, const std::vector<ChannelComparison>& channels);

}  // namespace slewlab::tools
