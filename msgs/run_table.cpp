#include "msgs/run_table.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "msgs/file_order.h"

namespace slewlab::msgs {
namespace {

constexpr std::size_t kStretchBytes = 4 * 1024 * 1024;  // [bytes] of rows that are given out together

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
  FileOrder file = file_order(path_);
  for (std::size_t c = 0; c < kChannels; ++c) {
    const auto& votes = file.counts[c];
    const auto most = std::max_element(votes.begin(), votes.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    if (most != votes.end()) counts_[c] = most->first;
  }
  in_file_order_ = file.is_in_order;
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
    Lateness lateness;
    walk_ordered(std::vector<bool>(tables_.size(), true), [&](std::size_t, const EventHead& head) { lateness.add(head.time); });
    lateness_ = lateness.largest;
    return;
  }
  remarks_ = std::move(file.remarks);
  lateness_ = file.lateness;
  for (std::size_t c = 0; c < kChannels; ++c) {
    const ChannelExtent& extent = file.channels[c];
    if (extent.messages == 0) continue;
    lay_out(c, *counts_[c]);
    tables_.back().rows = extent.messages;
    tables_.back().first_time = extent.first_time;
    tables_.back().last_time = extent.last_time;
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

}  // namespace slewlab::msgs
