#pragma once

// Reads a log in LCM's event format (see log_writer.h), written by slewlab or by lcm-logger. Reads on
// through damage: where bytes are no event it looks for the next sync word, and a cut-off end ends the log.
// What could not be used is counted and can be told in words.

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "msgs/codec.h"
#include "msgs/log_writer.h"

namespace slewlab::msgs {

// Valid until the next call of LogReader::next.
struct LogEvent {
  std::int64_t number = 0;
  std::int64_t timestamp_us = 0;
  std::string_view channel;
  Bytes data;
};

struct LogDamage {
  std::int64_t skipped_bytes = 0;      // between events
  std::int64_t skipped_stretches = 0;  // number of such places
  std::int64_t cut_off_bytes = 0;      // of an event that the file's end cuts
  std::int64_t backward_stamps = 0;    // events stamped earlier than the one before (lcm-logger does that)
};

class LogReader {
 public:
  explicit LogReader(const std::filesystem::path& path);  // throws LogError: no such file, not readable

  bool next(LogEvent& event);  // false at the end

  const LogDamage& damage() const { return damage_; }

 private:
  std::size_t available() const { return end_ - begin_; }
  bool fill(std::size_t wanted);  // at least `wanted` bytes from begin_ on, false if the file has no more

  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::filesystem::path path_;
  std::unique_ptr<std::FILE, Close> file_;
  std::vector<std::uint8_t> buffer_;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  std::uintmax_t unread_bytes_ = 0;  // of the file, those in the buffer included
  std::int64_t last_stamp_us_ = INT64_MIN;
  LogDamage damage_;
};

// One line per kind of damage, empty if there is none.
std::vector<std::string> describe(const LogDamage& damage);

}  // namespace slewlab::msgs
