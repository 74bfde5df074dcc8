#include "msgs/log_reader.h"

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace slewlab::msgs {
namespace {

constexpr std::size_t kChunkBytes = 1024 * 1024;
constexpr std::size_t kLongestChannel = 63;                    // LCM_MAX_CHANNEL_NAME_LENGTH
constexpr std::size_t kLargestData = std::size_t{1} << 28;     // [bytes] LCM's own limit for a message

std::uint32_t get_32(const std::uint8_t* p) {
  return std::uint32_t{p[0]} << 24 | std::uint32_t{p[1]} << 16 | std::uint32_t{p[2]} << 8 | p[3];
}

std::int64_t get_64(const std::uint8_t* p) {
  return static_cast<std::int64_t>(std::uint64_t{get_32(p)} << 32 | get_32(p + 4));
}

}  // namespace

LogReader::LogReader(const std::filesystem::path& path)
    : path_(path), file_(std::fopen(path.c_str(), "rb")) {
  if (!file_) throw LogError("cannot read the log " + path.string() + ": " + std::strerror(errno));
  std::error_code error;
  unread_bytes_ = std::filesystem::file_size(path, error);
  if (error) throw LogError("cannot read the log " + path.string() + ": " + error.message());
  buffer_.resize(static_cast<std::size_t>(std::min<std::uintmax_t>(kChunkBytes, unread_bytes_)));
}

bool LogReader::fill(std::size_t wanted) {
  if (available() >= wanted) return true;
  if (available() > 0) std::memmove(buffer_.data(), buffer_.data() + begin_, available());
  end_ -= begin_;
  begin_ = 0;
  if (buffer_.size() < wanted) buffer_.resize(wanted);
  while (end_ < wanted) {
    const std::size_t count = std::fread(buffer_.data() + end_, 1, buffer_.size() - end_, file_.get());
    if (count == 0) {
      if (std::ferror(file_.get()) != 0) {
        throw LogError("cannot read the log " + path_.string() + ": " + std::strerror(errno));
      }
      return false;
    }
    end_ += count;
  }
  return true;
}

bool LogReader::next(LogEvent& event) {
  std::int64_t skipped = 0;       // bytes in front of the event that comes out
  std::int64_t cut_event_at = -1; // how many of them lie before a head whose event would reach beyond the end
  const auto skip = [&](std::size_t bytes) {
    skipped += static_cast<std::int64_t>(bytes);
    begin_ += bytes;
    unread_bytes_ -= bytes;
  };
  for (;;) {
    if (!fill(kLogEventHeadBytes)) {
      const std::int64_t all = skipped + static_cast<std::int64_t>(available());
      // What follows the last whole event is an event cut off if a head stands there, or too little for a
      // head.
      const std::int64_t cut = cut_event_at >= 0 ? all - cut_event_at : static_cast<std::int64_t>(available());
      damage_.cut_off_bytes += cut;
      if (all > cut) ++damage_.skipped_stretches;
      damage_.skipped_bytes += all - cut;
      skip(available());
      return false;
    }
    const std::uint8_t* head = buffer_.data() + begin_;
    if (get_32(head) != kLogSyncWord) {
      const std::uint8_t first = kLogSyncWord >> 24;
      const std::uint8_t* found =
          std::find(head + 1, static_cast<const std::uint8_t*>(buffer_.data() + end_), first);
      skip(static_cast<std::size_t>(found - head));
      continue;
    }
    const std::size_t channel_bytes = get_32(head + 20);
    const std::size_t data_bytes = get_32(head + 24);
    if (channel_bytes == 0 || channel_bytes > kLongestChannel || data_bytes > kLargestData) {
      skip(1);
      continue;
    }
    const std::size_t whole = kLogEventHeadBytes + channel_bytes + data_bytes;
    if (whole > unread_bytes_ || !fill(whole)) {
      // Either the end cuts this event, or its length is damaged and whole events follow.
      if (cut_event_at < 0) cut_event_at = skipped;
      skip(1);
      continue;
    }
    head = buffer_.data() + begin_;
    event.number = get_64(head + 4);
    event.timestamp_us = get_64(head + 12);
    event.channel = std::string_view(reinterpret_cast<const char*>(head + kLogEventHeadBytes), channel_bytes);
    event.data = Bytes(head + kLogEventHeadBytes + channel_bytes, data_bytes);
    begin_ += whole;
    unread_bytes_ -= whole;
    if (skipped > 0) ++damage_.skipped_stretches;
    damage_.skipped_bytes += skipped;
    if (event.timestamp_us < last_stamp_us_) ++damage_.backward_stamps;
    last_stamp_us_ = event.timestamp_us;
    return true;
  }
}

std::vector<std::string> describe(const LogDamage& damage) {
  std::vector<std::string> lines;
  if (damage.skipped_bytes > 0) {
    lines.push_back(std::to_string(damage.skipped_bytes) + " bytes in " +
                    std::to_string(damage.skipped_stretches) + " places are no event and were skipped");
  }
  if (damage.cut_off_bytes > 0) {
    lines.push_back("the end is cut off: " + std::to_string(damage.cut_off_bytes) +
                    " bytes of an incomplete event were left out");
  }
  if (damage.backward_stamps > 0) {
    lines.push_back(std::to_string(damage.backward_stamps) +
                    " events carry an earlier time stamp than the one before them");
  }
  return lines;
}

}  // namespace slewlab::msgs
