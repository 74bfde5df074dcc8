#include "msgs/log_reader.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>

namespace slewlab::msgs {
namespace {

constexpr std::size_t kChunkBytes = 1024 * 1024;
constexpr std::size_t kLargeEvent = kChunkBytes;               // [bytes] chosen: no message of ours is that large
constexpr std::size_t kLongestChannel = 63;                    // LCM_MAX_CHANNEL_NAME_LENGTH
constexpr std::size_t kLargestData = std::size_t{1} << 28;     // [bytes] LCM's own limit for a message

std::uint32_t get_32(const std::uint8_t* p) {
  return std::uint32_t{p[0]} << 24 | std::uint32_t{p[1]} << 16 | std::uint32_t{p[2]} << 8 | p[3];
}

std::int64_t get_64(const std::uint8_t* p) {
  return static_cast<std::int64_t>(std::uint64_t{get_32(p)} << 32 | get_32(p + 4));
}

constexpr std::array<std::uint8_t, 4> kSync{kLogSyncWord >> 24 & 0xff, kLogSyncWord >> 16 & 0xff, kLogSyncWord >> 8 & 0xff,
                                            kLogSyncWord & 0xff};

// [bytes] of the event that begins at `head`, by what its head says; 0 where that cannot be. `available` bytes are there.
std::size_t whole_event(const std::uint8_t* head, std::size_t available) {
  if (available < kLogEventHeadBytes) return 0;
  const EventLengths lengths = event_lengths(head);
  return lengths.channel == 0 ? 0 : kLogEventHeadBytes + lengths.channel + lengths.data;
}

}  // namespace

EventLengths event_lengths(const std::uint8_t* head) {
  const std::size_t channel_bytes = get_32(head + 20);
  const std::size_t data_bytes = get_32(head + 24);
  if (get_32(head) != kLogSyncWord || channel_bytes == 0 || channel_bytes > kLongestChannel || data_bytes > kLargestData) return {};
  return {channel_bytes, data_bytes};
}

LogEvent event_of(const std::uint8_t* head, const EventLengths& lengths, std::int64_t offset) {
  const std::uint8_t* channel = head + kLogEventHeadBytes;
  return {.offset = offset,
          .number = get_64(head + 4),
          .timestamp_us = get_64(head + 12),
          .channel = std::string_view(reinterpret_cast<const char*>(channel), lengths.channel),
          .data = Bytes(channel + lengths.channel, lengths.data)};
}

LogReader::LogReader(const std::filesystem::path& path)
    : path_(path), file_(std::fopen(path.c_str(), "rb")) {
  if (!file_) throw LogError("cannot read the log " + path.string() + ": " + std::strerror(errno));
  std::error_code error;
  unread_bytes_ = std::filesystem::file_size(path, error);
  if (error) throw LogError("cannot read the log " + path.string() + ": " + error.message());
  size_ = static_cast<std::int64_t>(unread_bytes_);
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

bool LogReader::is_followed_by_event(std::size_t whole) {
  if (whole == unread_bytes_) return true;  // the end of the file
  if (whole + 4 > unread_bytes_) return false;
  if (fill(whole + 4)) return get_32(buffer_.data() + begin_ + whole) == kLogSyncWord;
  return false;
}

bool LogReader::is_event(std::size_t whole) {
  if (whole > unread_bytes_) return false;
  if (whole > kLargeEvent) {
    // Looked up in the file, for a damaged length may say anything: filling the buffer for each would take for ever.
    if (whole < unread_bytes_) {
      std::uint8_t word[4] = {};
      const auto at = static_cast<off_t>(size_ - static_cast<std::int64_t>(unread_bytes_) + static_cast<std::int64_t>(whole));
      if (::pread(::fileno(file_.get()), word, sizeof word, at) != sizeof word || get_32(word) != kLogSyncWord) return false;
    }
    return fill(whole);
  }
  if (!fill(whole)) return false;
  // Where another event lies inside of it, or begins there while none follows, its length is damaged. Where nothing of
  // that kind is inside, what follows may be damaged.
  const bool followed = is_followed_by_event(whole);
  const std::uint8_t* begin = buffer_.data() + begin_;
  const std::uint8_t* end = begin + (followed ? whole : std::min(whole + 3, available()));  // one may reach beyond
  for (const std::uint8_t* inner = begin + 1;; ++inner) {
    inner = std::search(inner, end, kSync.begin(), kSync.end());
    if (inner == end) return true;
    if (!followed) return false;
    const std::size_t inner_whole = whole_event(inner, static_cast<std::size_t>(end - inner));
    if (inner_whole > 0 && inner_whole <= static_cast<std::size_t>(end - inner)) return false;
  }
}

void LogReader::note_damage(std::int64_t offset, std::int64_t bytes) {
  if (bytes > 0 && damage_.places.size() < LogDamage::kPlaces) {
    damage_.places.push_back({offset, bytes, any_event_ ? last_stamp_us_ : -1});
  }
}

bool LogReader::next(LogEvent& event) {
  const std::int64_t begin_offset = size_ - static_cast<std::int64_t>(unread_bytes_);
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
      note_damage(begin_offset, all);
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
    const std::size_t whole = whole_event(head, available());
    if (whole == 0) {
      skip(1);
      continue;
    }
    if (!is_event(whole)) {
      // Either the end cuts this event, or its length is damaged and whole events follow.
      if (whole > unread_bytes_ && cut_event_at < 0) cut_event_at = skipped;
      skip(1);
      continue;
    }
    head = buffer_.data() + begin_;
    event = event_of(head, event_lengths(head), size_ - static_cast<std::int64_t>(unread_bytes_));
    begin_ += whole;
    unread_bytes_ -= whole;
    if (skipped > 0) ++damage_.skipped_stretches;
    damage_.skipped_bytes += skipped;
    note_damage(begin_offset, skipped);
    if (any_event_ && event.timestamp_us < last_stamp_us_) ++damage_.backward_stamps;
    last_stamp_us_ = event.timestamp_us;
    any_event_ = true;
    return true;
  }
}

std::vector<std::string> describe(const LogDamage& damage) {
  std::vector<std::string> lines;
  const auto where = [&] {
    std::string text;
    for (const LogDamagePlace& place : damage.places) {
      text += (text.empty() ? ": " : ", ") + std::to_string(place.bytes) + " at byte " + std::to_string(place.offset);
      if (place.behind_stamp_us < 0) continue;
      std::array<char, 32> seconds{};
      std::snprintf(seconds.data(), seconds.size(), " behind %.3f s", static_cast<double>(place.behind_stamp_us) * 1e-6);
      text += seconds.data();
    }
    const std::int64_t all = damage.skipped_stretches + (damage.cut_off_bytes > 0 ? 1 : 0);
    return text + (all > static_cast<std::int64_t>(damage.places.size()) ? " ..." : "");
  };
  if (damage.skipped_bytes > 0) {
    lines.push_back(std::to_string(damage.skipped_bytes) + " bytes in " +
                    std::to_string(damage.skipped_stretches) + (damage.skipped_stretches == 1 ? " place" : " places") +
                    " are no event and were skipped" + where());
  }
  if (damage.cut_off_bytes > 0) {
    lines.push_back("the end is cut off: " + std::to_string(damage.cut_off_bytes) +
                    " bytes of an incomplete event were left out" + (damage.skipped_bytes > 0 ? "" : where()));
  }
  if (damage.backward_stamps > 0) {
    lines.push_back(std::to_string(damage.backward_stamps) +
                    " events carry an earlier time stamp than the one before them");
  }
  return lines;
}

std::int64_t log_digest(const std::filesystem::path& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose);
  if (!file) throw LogError("cannot read the log " + path.string() + ": " + std::strerror(errno));
  std::vector<std::uint8_t> bytes(kChunkBytes);
  std::int64_t digest = kHashOfNothing;
  while (const std::size_t count = std::fread(bytes.data(), 1, bytes.size(), file.get())) {
    digest = continued_hash(digest, Bytes(bytes.data(), count));
  }
  if (std::ferror(file.get()) != 0) throw LogError("cannot read the log " + path.string() + ": " + std::strerror(errno));
  return digest;
}

std::string printable_channel(std::string_view channel) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const char c : channel) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x20 && byte < 0x7f && c != '\\') {
      text += c;
    } else {
      text += {'\\', 'x', kDigits[byte >> 4], kDigits[byte & 15]};
    }
  }
  return text;
}

}  // namespace slewlab::msgs
