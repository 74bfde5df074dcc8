#pragma once

// A log that a thread with deadlines can write to: put() copies the event into memory set aside beforehand and
// returns; a thread of its own writes to the file. Where the file cannot keep up and the memory is full, events are
// left out and counted.

#include <atomic>
#include <cstdint>
#include <exception>
#include <thread>
#include <vector>

#include "msgs/log_writer.h"

namespace slewlab::msgs {

class LogQueue {
 public:
  static constexpr std::size_t kBytes = std::size_t{1} << 24;  // 16 MiB: a minute of an ordinary run

  explicit LogQueue(LogWriter& writer, std::size_t bytes = kBytes);
  ~LogQueue();  // as finish(), but says nothing of errors
  LogQueue(const LogQueue&) = delete;
  LogQueue& operator=(const LogQueue&) = delete;

  // From one thread only. `channel` must live as long as the queue. Allocates, locks and waits for nothing.
  void put(const char* channel, std::int64_t timestamp_us, Bytes data);

  std::int64_t left_out() const { return left_out_; }
  bool failed() const { return failed_; }  // finish() will throw

  // Everything is in the file; throws what writing threw. No put() after it.
  void finish();

 private:
  struct Head {
    const char* channel;
    std::int64_t timestamp_us;
    std::size_t size;
  };
  void copy_in(std::size_t at, const void* from, std::size_t size);
  void copy_out(std::size_t at, void* to, std::size_t size) const;
  bool write_what_waits();
  void write();

  LogWriter& writer_;
  std::vector<std::uint8_t> ring_;
  std::atomic<std::size_t> put_{0};    // bytes put since the start
  std::atomic<std::size_t> taken_{0};  // bytes written since the start
  std::atomic<bool> ending_{false};
  std::atomic<bool> failed_{false};
  std::int64_t left_out_ = 0;
  std::exception_ptr error_;
  std::vector<std::uint8_t> data_;
  std::thread thread_;
};

}  // namespace slewlab::msgs
