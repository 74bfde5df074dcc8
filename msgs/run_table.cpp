#include "msgs/run_table.h"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

namespace slewlab::msgs {
namespace {

constexpr std::size_t kStretchBytes = 4 * 1024 * 1024;  // [bytes] of rows that are given out together
constexpr std::uint64_t kLongestStep = 1'000'000'000;   // [ns] that is no leap in any log (msgs/run_order.h)
constexpr std::size_t kFewPeriods = 64;                 // chosen: that are counted one by one

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

// Rows that wait to be given out together.
struct RunTables::Buffers {
  const RunTables& tables;
  const Taker& taker;
  std::vector<std::vector<std::uint8_t>> rows;
  std::size_t filled = 0;

  void add(std::size_t table, Bytes message) {
    append_row(tables.tables_[table], message, rows[table]);
    filled += tables.tables_[table].row_bytes;
    if (filled >= kStretchBytes) flush();
  }
  void flush() {
    for (std::size_t t = 0; t < rows.size(); ++t) {
      if (rows[t].empty()) continue;
      taker.rows(t, rows[t].size() / tables.tables_[t].row_bytes, rows[t]);
      rows[t].clear();
    }
    if (filled > 0) taker.end_of_stretch();
    filled = 0;
  }
};

RunTables::RunTables(std::filesystem::path path) : path_(std::move(path)) {
  Scans scans;
  Unused unused;
  std::int64_t configuration_hash = 0, run_identity = 0;
  constexpr std::int64_t kBeforeAll = std::numeric_limits<std::int64_t>::min();  // [ns]
  std::int64_t latest = kBeforeAll;
  bool any = false, one_run = true;
  LogReader reader(path_);
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
    if (!any) {
      configuration_hash = head.configuration_hash;
      run_identity = head.run_identity;
      any = true;
    }
    one_run = one_run && head.configuration_hash == configuration_hash && head.run_identity == run_identity;
    ++scans[*channel].counts[counts];
    scans[*channel].add(head);
    note_time(head.simulated_time, latest);
  }

  for (std::size_t c = 0; c < kChannels; ++c) {
    const auto& votes = scans[c].counts;
    const auto most = std::max_element(votes.begin(), votes.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    if (most != votes.end()) counts_[c] = most->first;
  }
  in_file_order_ = any && one_run && is_in_order(scans);
  if (!in_file_order_) {
    RunOrder order = order_runs(path_, counts_);
    const auto longest = std::max_element(order.runs.begin(), order.runs.end(),
                                          [&](const OrderedRun& a, const OrderedRun& b) { return a.messages < b.messages; });
    remarks_ = std::move(order.remarks);
    if (order.runs.size() > 1) {
      remarks_.push_back("the file holds " + std::to_string(order.runs.size()) + " runs; used is the longest one, of " +
                         std::to_string(longest->messages) + " messages");
    }
    run_ = std::move(*longest);
    for (std::size_t c = 0; c < kChannels; ++c) {
      const auto& heads = run_.channels[c];
      if (heads.empty()) continue;
      lay_out(c, *counts_[c]);
      const auto [first, last] = std::minmax_element(heads.begin(), heads.end(), [](const EventHead& a, const EventHead& b) { return a.time < b.time; });
      tables_.back().rows = static_cast<std::int64_t>(heads.size());
      tables_.back().first_time = first->time;
      tables_.back().last_time = last->time;
    }
    latest = kBeforeAll;
    lateness_ = 0;
    walk_ordered(std::vector<bool>(tables_.size(), true), [&](std::size_t, const EventHead& head) { note_time(head.time, latest); });
    return;
  }
  remarks_ = describe(unused, reader.damage());
  for (std::size_t c = 0; c < kChannels; ++c) {
    const ChannelScan& scan = scans[c];
    if (scan.messages == 0) continue;
    lay_out(c, *counts_[c]);
    tables_.back().rows = scan.different();
    tables_.back().first_time = scan.first_time;
    tables_.back().last_time = scan.last_time;
    describe_order(wire_messages()[c].channel, true, scan.repeated, scan.different(), scan.first_key, scan.last_key, remarks_);
  }
}

void RunTables::lay_out(std::size_t channel, const ArrayCounts& counts) {
  tables_.emplace_back();
  static_cast<RowLayout&>(tables_.back()) = row_layout(channel, counts);
}

void RunTables::read(const std::vector<bool>& asked, const Taker& taker) const {
  Buffers buffers{*this, taker, std::vector<std::vector<std::uint8_t>>(tables_.size()), 0};
  if (in_file_order_) {
    read_in_file_order(asked, buffers);
  } else {
    read_ordered(asked, buffers);
  }
  buffers.flush();
}

void RunTables::read_in_file_order(const std::vector<bool>& asked, Buffers& buffers) const {
  std::array<std::optional<std::size_t>, kChannels> table_of;
  for (std::size_t t = 0; t < tables_.size(); ++t) {
    if (asked[t]) table_of[tables_[t].channel] = t;
  }
  std::vector<std::optional<std::int64_t>> last_key(tables_.size());
  LogReader reader(path_);
  LogEvent event;
  while (reader.next(event)) {
    const std::optional<std::size_t> channel = channel_index(event.channel);
    if (!channel || !table_of[*channel]) continue;
    const WireMessage& wire = wire_messages()[*channel];
    ArrayCounts counts;
    if (check(event.data, wire.fingerprint, wire.pieces, counts) != DecodeStatus::ok || counts != *counts_[*channel]) continue;
    const std::size_t table = *table_of[*channel];
    const std::int64_t key = head_of(event.data, wire).key;
    if (last_key[table] == key) continue;
    last_key[table] = key;
    buffers.add(table, event.data);
  }
}

// Each channel in the order of its keys; whose turn it is, the place in the file says. take(table, head).
template <class Take>
void RunTables::walk_ordered(const std::vector<bool>& asked, Take take) const {
  std::vector<std::size_t> next(tables_.size(), 0);
  for (;;) {
    std::optional<std::size_t> first;
    std::int64_t lowest = std::numeric_limits<std::int64_t>::max();
    for (std::size_t t = 0; t < tables_.size(); ++t) {
      const auto& heads = run_.channels[tables_[t].channel];
      if (!asked[t] || next[t] == heads.size() || heads[next[t]].offset > lowest) continue;
      first = t;
      lowest = heads[next[t]].offset;
    }
    if (!first) return;
    take(*first, run_.channels[tables_[*first].channel][next[*first]++]);
  }
}

void RunTables::read_ordered(const std::vector<bool>& asked, Buffers& buffers) const {
  EventsAt events(path_);
  walk_ordered(asked, [&](std::size_t table, const EventHead& head) {
    const std::size_t channel = tables_[table].channel;
    const WireMessage& wire = wire_messages()[channel];
    const Bytes message = events.data(head.offset);
    ArrayCounts counts;
    if (check(message, wire.fingerprint, wire.pieces, counts) != DecodeStatus::ok || counts != *counts_[channel]) {
      throw LogError("the log " + path_.string() + " changed while it was read: the message at byte " + std::to_string(head.offset));
    }
    buffers.add(table, message);
  });
}

// How far a time lies behind the latest one before it.
void RunTables::note_time(std::int64_t time, std::int64_t& latest) {
  constexpr std::uint64_t kMost = std::numeric_limits<std::int64_t>::max();
  if (time < latest) lateness_ = std::max(lateness_, static_cast<std::int64_t>(std::min(distance(time, latest), kMost)));
  latest = std::max(latest, time);
}

}  // namespace slewlab::msgs
