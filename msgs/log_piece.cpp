#include "msgs/log_piece.h"

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

namespace slewlab::msgs {
namespace {

// [bytes] where the messages of the piece stand, of one channel.
std::vector<std::int64_t> offsets_of(const std::vector<EventHead>& messages, const LogPiece& piece, bool is_held) {
  std::vector<std::int64_t> offsets;
  const EventHead* before = nullptr;
  for (const EventHead& message : messages) {
    if (message.time < piece.from) {
      before = &message;
    } else if (message.time <= piece.to) {
      offsets.push_back(message.offset);
    }
  }
  if (is_held && before != nullptr) offsets.push_back(before->offset);
  return offsets;
}

}  // namespace

LogPiece whole_run(const OrderedRun& run) {
  LogPiece whole{std::numeric_limits<std::int64_t>::max(), std::numeric_limits<std::int64_t>::min()};
  const auto take = [&](const std::vector<EventHead>& messages) {
    for (const EventHead& message : messages) whole = {std::min(whole.from, message.time), std::max(whole.to, message.time)};
  };
  take(run.channels[kEncoderIndex]);
  if (run.channels[kEncoderIndex].empty()) std::for_each(run.channels.begin(), run.channels.end(), take);
  return whole;
}

std::array<std::int64_t, kChannels> write_piece(const std::filesystem::path& path, const OrderedRun& run, const LogPiece& piece, LogWriter& writer) {
  std::array<std::int64_t, kChannels> counts{};
  std::vector<std::int64_t> offsets;
  for (std::size_t channel = 0; channel < kChannels; ++channel) {
    const bool is_held = std::find(kHeld.begin(), kHeld.end(), channel) != kHeld.end();
    const std::vector<std::int64_t> of_channel = offsets_of(run.channels[channel], piece, is_held);
    counts[channel] = static_cast<std::int64_t>(of_channel.size());
    offsets.insert(offsets.end(), of_channel.begin(), of_channel.end());
  }
  std::sort(offsets.begin(), offsets.end());
  EventsAt events(path);
  for (const std::int64_t offset : offsets) {
    const LogEvent event = events.event(offset);
    writer.append(event.channel, event.timestamp_us, event.data);
  }
  return counts;
}

}  // namespace slewlab::msgs
