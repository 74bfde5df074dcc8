#pragma once

// Whether the rules of msgs/run_order.h leave every message of a log where it is: one run, without strays, in order. One
// reading of the log shows it, in memory that does not grow with the log. Says yes only where that is sure.

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "msgs/log_reader.h"
#include "msgs/run_order.h"
#include "msgs/wire_layout.h"

namespace slewlab::msgs {

// First and last message of a channel of a run, and how many there are, repeated ones left out.
struct ChannelExtent {
  std::int64_t messages = 0;
  std::int64_t first_key = 0, first_time = 0;  // [ns]
  std::int64_t last_key = 0, last_time = 0;    // [ns]
};

struct FileOrder {
  bool any_message = false;  // of slewlab
  bool is_in_order = false;
  std::array<std::map<ArrayCounts, std::int64_t>, kChannels> counts;  // of messages whose arrays have these lengths
  // Where it is in order:
  std::int64_t configuration_hash = 0;
  std::int64_t run_identity = 0;
  std::array<ChannelExtent, kChannels> channels;
  std::int64_t lateness = 0;         // [ns] by which a time lies behind the latest one before it in the file
  std::vector<std::string> remarks;  // what could not be used, one line each
  std::int64_t lost_bytes = 0;       // as in RunLogs
  std::int64_t lost_messages = 0;
};

// Throws LogError where the file cannot be read.
FileOrder file_order(const std::filesystem::path& path);

// The messages of one channel of a log that is in order, one after the other.
class EventsInOrder {
 public:
  EventsInOrder(const std::filesystem::path& path, std::size_t channel);
  std::optional<Bytes> next();  // valid until the next call; nothing behind the last

 private:
  LogReader reader_;
  std::size_t channel_;
  std::optional<std::int64_t> last_key_;
};

// How far a time lies behind the latest one before it, the largest yet.
struct Lateness {
  std::optional<std::int64_t> latest;  // [ns]
  std::int64_t largest = 0;            // [ns]
  void add(std::int64_t time);
};

}  // namespace slewlab::msgs
