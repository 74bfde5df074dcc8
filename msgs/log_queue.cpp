#include "msgs/log_queue.h"

#include <pthread.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstring>
#include <utility>

namespace slewlab::msgs {

LogQueue::LogQueue(LogWriter& writer, std::size_t bytes) : writer_(writer), ring_(bytes) {
  // The signals of a process belong to its main thread.
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  thread_ = std::thread([this] { write(); });
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

LogQueue::~LogQueue() {
  ending_ = true;
  if (thread_.joinable()) thread_.join();
}

void LogQueue::copy_in(std::size_t at, const void* from, std::size_t size) {
  const std::size_t begin = at % ring_.size();
  const std::size_t first = std::min(size, ring_.size() - begin);
  std::memcpy(ring_.data() + begin, from, first);
  std::memcpy(ring_.data(), static_cast<const std::uint8_t*>(from) + first, size - first);
}

void LogQueue::copy_out(std::size_t at, void* to, std::size_t size) const {
  const std::size_t begin = at % ring_.size();
  const std::size_t first = std::min(size, ring_.size() - begin);
  std::memcpy(to, ring_.data() + begin, first);
  std::memcpy(static_cast<std::uint8_t*>(to) + first, ring_.data(), size - first);
}

void LogQueue::put(const char* channel, std::int64_t timestamp_us, Bytes data) {
  const std::size_t at = put_.load(std::memory_order_relaxed);
  const std::size_t whole = sizeof(Head) + data.size();
  if (whole > ring_.size() - (at - taken_.load(std::memory_order_acquire))) {
    ++left_out_;
    return;
  }
  const Head head{channel, timestamp_us, data.size()};
  copy_in(at, &head, sizeof head);
  if (!data.empty()) copy_in(at + sizeof head, data.data(), data.size());
  put_.store(at + whole, std::memory_order_release);
}

bool LogQueue::write_what_waits() {
  const std::size_t end = put_.load(std::memory_order_acquire);
  std::size_t at = taken_.load(std::memory_order_relaxed);
  if (at == end) return false;
  while (at != end) {
    Head head;
    copy_out(at, &head, sizeof head);
    data_.resize(head.size);
    if (head.size > 0) copy_out(at + sizeof head, data_.data(), head.size);
    writer_.append(head.channel, head.timestamp_us, data_);
    at += sizeof head + head.size;
    taken_.store(at, std::memory_order_release);
  }
  writer_.flush();
  return true;
}

void LogQueue::write() {
  constexpr std::chrono::milliseconds kPause{50};
  try {
    while (true) {
      const bool ending = ending_;
      if (!write_what_waits() && ending) return;
      if (!ending) std::this_thread::sleep_for(kPause);
    }
  } catch (...) {
    error_ = std::current_exception();
    failed_ = true;
  }
}

void LogQueue::finish() {
  ending_ = true;
  if (thread_.joinable()) thread_.join();
  if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
}

}  // namespace slewlab::msgs
