#include "msgs/log_writer.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace slewlab::msgs {
namespace {

// Large enough that the write costs nothing per event, small enough that a killed process loses little.
constexpr std::size_t kBufferBytes = 64 * 1024;

void put_32(std::uint8_t*& p, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) *p++ = static_cast<std::uint8_t>(value >> shift);
}

void put_64(std::uint8_t*& p, std::uint64_t value) {
  for (int shift = 56; shift >= 0; shift -= 8) *p++ = static_cast<std::uint8_t>(value >> shift);
}

}  // namespace

std::filesystem::path partial_log_path(const std::filesystem::path& path) {
  std::filesystem::path partial = path;
  partial += ".partial";
  return partial;
}

LogWriter::LogWriter(std::filesystem::path path) : path_(std::move(path)) {
  const std::filesystem::path partial = partial_log_path(path_);
  fd_ = ::open(partial.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (fd_ < 0) throw LogError("cannot write the log " + partial.string() + ": " + std::strerror(errno));
  // A log of an earlier run must not be taken for this one's.
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
  buffer_.reserve(kBufferBytes + 4096);
}

LogWriter::~LogWriter() {
  if (fd_ < 0) return;
  try {
    flush();
  } catch (const LogError&) {
    // The file holds whole events up to here, which is all that a destructor can promise.
  }
  if (fd_ >= 0) ::close(fd_);
}

void LogWriter::append(std::string_view channel, std::int64_t timestamp_us, Bytes data) {
  const std::size_t begin = buffer_.size();
  buffer_.resize(begin + kLogEventHeadBytes + channel.size() + data.size());
  std::uint8_t* p = buffer_.data() + begin;
  put_32(p, kLogSyncWord);
  put_64(p, static_cast<std::uint64_t>(event_count_));
  put_64(p, static_cast<std::uint64_t>(timestamp_us));
  put_32(p, static_cast<std::uint32_t>(channel.size()));
  put_32(p, static_cast<std::uint32_t>(data.size()));
  std::memcpy(p, channel.data(), channel.size());
  if (!data.empty()) std::memcpy(p + channel.size(), data.data(), data.size());
  digest_ = continued_hash(digest_, Bytes(buffer_).subspan(begin));
  ++event_count_;
  if (buffer_.size() >= kBufferBytes) flush();
}

void LogWriter::flush() {
  if (fd_ < 0 && !buffer_.empty()) throw LogError("the log " + path_.string() + " is closed");
  std::size_t done = 0;
  while (done < buffer_.size()) {
    const ssize_t count = ::write(fd_, buffer_.data() + done, buffer_.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      const int error_number = count < 0 ? errno : ENOSPC;
      // Whole events that did get through stay; the one that was cut goes.
      std::size_t whole = 0;
      while (whole + kLogEventHeadBytes <= done) {
        const std::uint8_t* head = buffer_.data() + whole;
        const auto length = [&](std::size_t at) {
          return std::size_t{head[at]} << 24 | std::size_t{head[at + 1]} << 16 | std::size_t{head[at + 2]} << 8 |
                 std::size_t{head[at + 3]};
        };
        const std::size_t event = kLogEventHeadBytes + length(20) + length(24);
        if (whole + event > done) break;
        whole += event;
        ++flushed_event_count_;
      }
      written_ += static_cast<std::int64_t>(whole);
      fail(error_number);
    }
    done += static_cast<std::size_t>(count);
  }
  written_ += static_cast<std::int64_t>(buffer_.size());
  flushed_event_count_ = event_count_;
  buffer_.clear();
}

void LogWriter::finish() {
  flush();
  const int fd = fd_;
  fd_ = -1;
  // Some file systems report a full disk only here.
  if (::close(fd) != 0) {
    throw LogError("cannot close the log " + partial_log_path(path_).string() + ": " + std::strerror(errno));
  }
  std::error_code error;
  std::filesystem::rename(partial_log_path(path_), path_, error);
  if (error) throw LogError("cannot give the log its name " + path_.string() + ": " + error.message());
}

void LogWriter::fail(int error_number) {
  buffer_.clear();
  const bool cut = ::ftruncate(fd_, written_) == 0;
  ::close(fd_);
  fd_ = -1;
  throw LogError("cannot write the log " + partial_log_path(path_).string() + ": " +
                 std::strerror(error_number) + "; " + std::to_string(flushed_event_count_) + " events (" +
                 std::to_string(written_) + " bytes) are in it and intact" +
                 (cut ? "" : ", behind them an incomplete one"));
}

}  // namespace slewlab::msgs
