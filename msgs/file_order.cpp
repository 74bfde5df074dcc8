#include "msgs/file_order.h"

#include <algorithm>
#include <limits>

namespace slewlab::msgs {
namespace {

constexpr std::uint64_t kLongestStep = 1'000'000'000;  // [ns] that is no leap in any log (msgs/run_order.h)
constexpr std::size_t kFewPeriods = 64;                // chosen: that are counted one by one

std::uint64_t distance(std::int64_t from, std::int64_t to) {
  return static_cast<std::uint64_t>(to) - static_cast<std::uint64_t>(from);
}

// What one reading shows of a channel, in memory that does not grow with it.
struct ChannelScan {
  std::map<ArrayCounts, std::int64_t> counts;
  std::int64_t messages = 0;
  std::int64_t repeated = 0;
  std::int64_t first_key = 0, first_time = 0;  // [ns]
  std::int64_t last_key = 0, last_time = 0;    // [ns]
  bool rises = true;    // neither sequence number nor time falls, and no number comes at two times
  bool on_line = true;  // time = offset + period * key
  std::uint64_t period = 0;        // [ns] of that line
  std::uint64_t longest_step = 0;  // [ns]
  std::map<std::uint64_t, std::int64_t> periods;  // how often two messages lie so far apart per key; the first kinds
  std::int64_t further_periods = 0;

  void add(const WireHead& head) {
    if (messages++ == 0) {
      first_key = last_key = head.key;
      first_time = last_time = head.simulated_time;
      return;
    }
    if (head.key == last_key && head.simulated_time == last_time) {
      ++repeated;
      return;
    }
    if (head.key <= last_key || head.simulated_time < last_time) {
      rises = false;
      return;
    }
    const std::uint64_t keys = distance(last_key, head.key);
    const std::uint64_t time = distance(last_time, head.simulated_time);
    longest_step = std::max(longest_step, time);
    if (time % keys == 0 && time > 0) {
      const std::uint64_t here = time / keys;
      if (const auto known = periods.find(here); known != periods.end()) {
        ++known->second;
      } else if (periods.size() < kFewPeriods) {
        periods.emplace(here, 1);
      } else {
        ++further_periods;
      }
      if (period == 0) period = here;
      on_line = on_line && period == here;
    } else {
      on_line = false;
    }
    last_key = head.key;
    last_time = head.simulated_time;
  }

  std::int64_t different() const { return messages - repeated; }
  bool has_line() const { return on_line && different() > 1; }
  // Where nine messages in ten lay on a line, eight pairs of neighbours in ten would have its period.
  bool surely_no_line() const {
    std::int64_t most = further_periods;
    for (const auto& [kind, votes] : periods) most = std::max(most, votes);
    return different() < 2 || 10 * (most + repeated + 1) < 8 * (messages - 1);
  }
  bool is_on_line_of(const ChannelScan& other) const {
    if (!on_line || (different() > 1 && period != other.period)) return false;
    const std::uint64_t since = distance(other.first_time, first_time);
    return since == other.period * distance(other.first_key, first_key);
  }
};

using Scans = std::array<ChannelScan, kChannels>;

// Whether msgs/run_order.h's rules leave every message of the file where it is: one run without strays, in order. Says yes
// only where that is sure.
bool is_in_order(const Scans& scans) {
  for (const ChannelScan& scan : scans) {
    if (!scan.rises || scan.counts.size() > 1) return false;
  }
  const ChannelScan& encoder = scans[kEncoderIndex];
  const ChannelScan* anchors = &encoder;
  if (encoder.different() < 2) {
    for (const std::size_t c : kPlantIndices) {
      if (scans[c].messages > anchors->messages) anchors = &scans[c];
    }
  }
  if (anchors->longest_step > kLongestStep) return false;
  if (!encoder.has_line() && !encoder.surely_no_line()) return false;
  for (std::size_t c = 0; c < kChannels; ++c) {
    const ChannelScan& scan = scans[c];
    if (scan.messages == 0 || c == kOperatorIndex) continue;
    if (wire_messages()[c].is_answer && encoder.has_line()) {
      if (!scan.is_on_line_of(encoder)) return false;
    } else if (!scan.has_line() && !scan.surely_no_line()) {
      return false;
    }
  }
  return true;
}

}  // namespace

void Lateness::add(std::int64_t time) {
  constexpr std::uint64_t kMost = std::numeric_limits<std::int64_t>::max();
  if (!latest) latest = time;
  if (time < *latest) largest = std::max(largest, static_cast<std::int64_t>(std::min(distance(time, *latest), kMost)));
  latest = std::max(*latest, time);
}

FileOrder file_order(const std::filesystem::path& path) {
  FileOrder order;
  Scans scans;
  Unused unused;
  Lateness lateness;
  bool one_run = true;
  LogReader reader(path);
  LogEvent event;
  while (reader.next(event)) {
    const std::optional<std::size_t> channel = channel_index(event.channel);
    if (!channel) {
      unused.add_foreign(event.channel);
      continue;
    }
    const WireMessage& wire = wire_messages()[*channel];
    ArrayCounts counts;
    const DecodeStatus status = check(event.data, wire.fingerprint, wire.pieces, counts);
    if (status != DecodeStatus::ok) {
      unused.undecodable[*channel].add(event.offset);
      unused.last_status[*channel] = status;
      continue;
    }
    const WireHead head = head_of(event.data, wire);
    if (!order.any_message) {
      order.configuration_hash = head.configuration_hash;
      order.run_identity = head.run_identity;
      order.any_message = true;
    }
    one_run = one_run && head.configuration_hash == order.configuration_hash && head.run_identity == order.run_identity;
    ++scans[*channel].counts[counts];
    scans[*channel].add(head);
    lateness.add(head.simulated_time);
  }
  order.is_in_order = order.any_message && one_run && is_in_order(scans);
  order.lateness = lateness.largest;
  order.remarks = describe(unused, reader.damage());
  order.lost_bytes = reader.damage().skipped_bytes + reader.damage().cut_off_bytes;
  for (const std::size_t c : kPlantIndices) order.lost_messages += unused.undecodable[c].count;
  order.lost_messages += unused.undecodable[kOperatorIndex].count;
  for (std::size_t c = 0; c < kChannels; ++c) {
    ChannelScan& scan = scans[c];
    order.counts[c] = std::move(scan.counts);
    if (scan.messages == 0) continue;
    order.channels[c] = {scan.different(), scan.first_key, scan.first_time, scan.last_key, scan.last_time};
    describe_order(wire_messages()[c].channel, true, scan.repeated, scan.different(), scan.first_key, scan.last_key, order.remarks);
  }
  return order;
}

EventsInOrder::EventsInOrder(const std::filesystem::path& path, std::size_t channel) : reader_(path), channel_(channel) {}

std::optional<Bytes> EventsInOrder::next() {
  const WireMessage& wire = wire_messages()[channel_];
  LogEvent event;
  while (reader_.next(event)) {
    if (event.channel != wire.channel) continue;
    ArrayCounts counts;
    if (check(event.data, wire.fingerprint, wire.pieces, counts) != DecodeStatus::ok) continue;
    const std::int64_t key = head_of(event.data, wire).key;
    if (last_key_ == key) continue;
    last_key_ = key;
    return event.data;
  }
  return std::nullopt;
}

}  // namespace slewlab::msgs
