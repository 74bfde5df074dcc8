#pragma once

// Reads a log in LCM's event format (see log_writer.h), written by slewlab or by lcm-logger. Reads on
// through damage: where bytes are no event it looks for the next sync word, and a cut-off end ends the log.
// An event inside of which another one lies, or begins while none follows, has a damaged length and is no event.
// What could not be used is counted and can be told in words. The time that reading takes is proportional to the
// file's size, the memory it takes to the largest event.

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

// Valid as long as the bytes that it was read from: until the next call of LogReader::next.
struct LogEvent {
  std::int64_t offset = 0;  // [bytes] of the event in the file
  std::int64_t number = 0;
  std::int64_t timestamp_us = 0;
  std::string_view channel;
  Bytes data;
};

// Where in the file bytes were of no use.
struct LogDamagePlace {
  std::int64_t offset = 0;            // [bytes]
  std::int64_t bytes = 0;
  std::int64_t behind_stamp_us = -1;  // time stamp of the event before it, -1: none
};

struct LogDamage {
  static constexpr std::size_t kPlaces = 5;  // that are kept; the rest is counted
  std::vector<LogDamagePlace> places;
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
  bool is_event(std::size_t whole);  // what begins at begin_ with a plausible head and is in the file
  bool is_followed_by_event(std::size_t whole);
  void note_damage(std::int64_t offset, std::int64_t bytes);

  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::filesystem::path path_;
  std::unique_ptr<std::FILE, Close> file_;
  std::vector<std::uint8_t> buffer_;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  std::int64_t size_ = 0;            // [bytes] of the file
  std::uintmax_t unread_bytes_ = 0;  // of the file, those in the buffer included
  std::int64_t last_stamp_us_ = -1;
  bool any_event_ = false;
  LogDamage damage_;
};

// [bytes] of the two parts behind an event's head, as the head says; 0 where that cannot be.
struct EventLengths {
  std::size_t channel = 0;
  std::size_t data = 0;
};
EventLengths event_lengths(const std::uint8_t* head);
// What stands in memory from `head` on, which is at `offset` in the file.
LogEvent event_of(const std::uint8_t* head, const EventLengths& lengths, std::int64_t offset);

// One line per kind of damage, empty if there is none.
std::vector<std::string> describe(const LogDamage& damage);

// Of the whole file, as LogWriter::digest() has it. Throws LogError.
std::int64_t log_digest(const std::filesystem::path& path);

// A channel's name as it may be shown: bytes that are no printable ASCII as \xNN, for a terminal obeys some of them.
std::string printable_channel(std::string_view channel);

}  // namespace slewlab::msgs
