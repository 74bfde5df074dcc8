#pragma once

// Writes a run's log in LCM's event format, the one lcm-logger writes and lcm-logplayer reads. Each event,
// big-endian: sync word 0xEDA1DA01, event number (64 bits), time stamp [us] (64), channel length (32), data
// length (32), channel, data.
//
// The format is written here and not by lcm::LogFile because that one hides a full disk until (or beyond) the
// closing of the file, and gives no way to cut the log back to its last complete event.
//
// The log grows under the name PATH.partial and gets its own name in finish(): a file named *.lcmlog is
// complete. A write error cuts the file back to its last complete event and throws LogError; events already
// written stay.

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "msgs/codec.h"
#include "msgs/configuration_hash.h"

namespace slewlab::msgs {

class LogError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

inline constexpr std::uint32_t kLogSyncWord = 0xEDA1DA01;
inline constexpr std::size_t kLogEventHeadBytes = 4 + 8 + 8 + 4 + 4;

std::filesystem::path partial_log_path(const std::filesystem::path& path);

class LogWriter {
 public:
  explicit LogWriter(std::filesystem::path path);  // throws LogError
  ~LogWriter();                                    // keeps what was written, under the partial name
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;

  // In lockstep the time stamp is the simulated time [us], so that two runs give the same bytes.
  void append(std::string_view channel, std::int64_t timestamp_us, Bytes data);

  void flush();   // everything appended so far is handed to the operating system
  void finish();  // flush, close, and give the file its own name

  std::int64_t event_count() const { return event_count_; }
  // Of every byte appended so far (FNV-1a, msgs/configuration_hash.h): by it a reader knows whether a file is as it was
  // written.
  std::int64_t digest() const { return digest_; }
  std::int64_t byte_count() const { return written_ + static_cast<std::int64_t>(buffer_.size()); }

 private:
  [[noreturn]] void fail(int error_number);

  std::filesystem::path path_;
  int fd_ = -1;
  std::vector<std::uint8_t> buffer_;  // whole events only
  std::int64_t written_ = 0;          // [bytes] in the file, always whole events
  std::int64_t event_count_ = 0;
  std::int64_t digest_ = kHashOfNothing;
  std::int64_t flushed_event_count_ = 0;
};

}  // namespace slewlab::msgs
