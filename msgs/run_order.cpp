#include "msgs/run_order.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <iterator>
#include <limits>
#include <set>
#include <utility>

#include "msgs/configuration_hash.h"

namespace slewlab::msgs {
namespace {

constexpr std::uint64_t kFallBack = 1'000'000'000;  // [ns] that messages may be out of order in the file
constexpr std::uint64_t kLeap = 1'000'000'000;      // [ns] ahead, or some of the usual distances
constexpr std::uint64_t kUsualDistances = 4;        // chosen: a message or two may be missing without a leap
constexpr std::ptrdiff_t kMostPieces = 20;          // chosen: of logs that were put together from parts
constexpr int kForeignChannels = 10;                // told by name
constexpr std::size_t kMostForeign = 1000;          // chosen: counted by name
constexpr std::size_t kWindowBytes = 64 * 1024;

using Heads = std::vector<EventHead>;

// Everything that carries one pair of configuration and run, in the order of the file.
struct Group {
  std::int64_t configuration_hash = 0;
  std::int64_t run_identity = 0;
  std::array<Heads, kChannels> channels;
};

struct Sorting {
  std::vector<Group> groups;  // in the order in which they begin in the file
  std::map<std::pair<std::int64_t, std::int64_t>, std::size_t> group_of;
  Unused unused;
};

// For any numbers that a damaged message may hold.
std::uint64_t distance(std::int64_t from, std::int64_t to) {
  return static_cast<std::uint64_t>(to) - static_cast<std::uint64_t>(from);
}
std::uint64_t size_of_difference(std::int64_t a, std::int64_t b) { return a < b ? distance(a, b) : distance(b, a); }

bool same_message(const EventHead& a, const EventHead& b) { return a.key == b.key && a.time == b.time; }

bool differ(const Heads& anchors) {
  return std::any_of(anchors.begin(), anchors.end(), [&](const EventHead& anchor) { return !same_message(anchor, anchors.front()); });
}

// The messages that tell the runs of the group apart, in the order of the file.
const Heads& anchors_of(const Group& group) {
  const Heads* best = &group.channels[kEncoderIndex];
  if (differ(*best)) return *best;
  for (const std::size_t c : kPlantIndices) {
    if (group.channels[c].size() > best->size()) best = &group.channels[c];
  }
  return *best;
}

bool is_run(const Group& group) {
  const auto channels =
      std::count_if(kPlantIndices.begin(), kPlantIndices.end(), [&](std::size_t c) { return !group.channels[c].empty(); });
  return channels > 1 || differ(anchors_of(group));
}

std::size_t size_of(const Group& group) {
  std::size_t size = 0;
  for (const Heads& channel : group.channels) size += channel.size();
  return size;
}

// [ns] beyond which simulated time leaps ahead.
std::uint64_t leap_of(const Heads& anchors) {
  std::vector<std::uint64_t> distances;
  for (std::size_t i = 1; i < anchors.size(); ++i) {
    const std::uint64_t size = size_of_difference(anchors[i - 1].time, anchors[i].time);
    if (size > 0) distances.push_back(size);
  }
  if (distances.empty()) return kLeap;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  constexpr std::uint64_t kLargest = std::numeric_limits<std::uint64_t>::max() / kUsualDistances;
  return std::max(kLeap, std::min(*middle, kLargest) * kUsualDistances);
}

// A run as it stands in the file.
struct Segment {
  Heads anchors;
};

// The runs of one pair; `strays` takes the offsets of the messages that leap and do not go on.
std::vector<Segment> segments_of(const Heads& anchors, std::set<std::int64_t>& strays) {
  const std::uint64_t leap = leap_of(anchors);
  const auto goes_on = [&](const EventHead& from, const EventHead& to) {
    return to.time < from.time ? distance(to.time, from.time) <= kFallBack : distance(from.time, to.time) <= leap;
  };
  std::vector<Segment> segments;
  Heads leapt;  // messages that agree with each other, but not yet a run
  const auto give_up = [&] {
    for (const EventHead& anchor : leapt) strays.insert(anchor.offset);
    leapt.clear();
  };
  for (const EventHead& anchor : anchors) {
    const bool on_run = !segments.empty() && goes_on(segments.back().anchors.back(), anchor);
    const bool on_leapt = !leapt.empty() && goes_on(leapt.back(), anchor);
    if (on_run && !(on_leapt && anchor.time < segments.back().anchors.back().time)) {
      give_up();
      segments.back().anchors.push_back(anchor);
      continue;
    }
    if (!on_leapt) give_up();
    leapt.push_back(anchor);
    if (same_message(leapt.front(), anchor)) continue;
    const bool another_run = segments.empty() || leapt.front().time < segments.back().anchors.back().time;
    if (another_run) segments.emplace_back();
    auto& joined = segments.back().anchors;
    joined.insert(joined.end(), leapt.begin(), leapt.end());
    leapt.clear();
  }
  if (segments.empty()) {
    segments.push_back({std::move(leapt)});
    leapt.clear();
  }
  give_up();
  return segments;
}

// A run that begins does so at its time 0 or, of a recorder that came later, where the recorder did. Where simulated time falls back
// again and again to somewhere in the middle, the messages are in no order, and what would come out apart are no runs.
void refuse_pieces(const std::vector<Segment>& segments, const std::filesystem::path& path) {
  std::int64_t earliest = std::numeric_limits<std::int64_t>::max();
  for (const Segment& segment : segments) {
    for (const EventHead& anchor : segment.anchors) earliest = std::min(earliest, anchor.time);
  }
  const auto pieces = std::count_if(segments.begin(), segments.end(), [&](const Segment& segment) {
    return !segment.anchors.empty() && distance(earliest, segment.anchors.front().time) > kFallBack;
  });
  if (pieces <= kMostPieces) return;
  throw LogError("the log " + path.string() + " holds its messages in no order: simulated time falls back " + std::to_string(segments.size() - 1) +
                 " times, mostly into the middle of a run; expected events in the order in which they were logged");
}

// Which segment a message belongs to: the one whose anchors stand around it in the file; between two the one whose time is
// nearer.
std::size_t segment_at(const std::vector<Segment>& segments, std::int64_t offset, std::int64_t time) {
  std::size_t s = 0;
  while (s + 1 < segments.size() && segments[s + 1].anchors.front().offset <= offset) ++s;
  if (s + 1 >= segments.size() || segments[s].anchors.empty() || segments[s].anchors.back().offset > offset) return s;
  const std::uint64_t to_this = size_of_difference(segments[s].anchors.back().time, time);
  const std::uint64_t to_next = size_of_difference(segments[s + 1].anchors.front().time, time);
  return to_next < to_this ? s + 1 : s;
}

// time = offset + period * sequence.
struct Line {
  std::int64_t period = 1;   // [ns] > 0
  std::uint64_t offset = 0;  // [ns]
  bool holds(std::int64_t key, std::int64_t time) const {
    const auto since = static_cast<std::int64_t>(static_cast<std::uint64_t>(time) - offset);
    return since % period == 0 && since / period == key;
  }
};

template <class Key>
Key commonest(const std::map<Key, std::int64_t>& counts) {
  return std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) { return a.second < b.second; })->first;
}

// The line that nine messages in ten lie on, if there is one.
std::optional<Line> line_of(const Heads& channel) {
  std::map<std::int64_t, std::int64_t> periods;
  for (std::size_t i = 1; i < channel.size(); ++i) {
    const EventHead& before = channel[i - 1];
    const EventHead& after = channel[i];
    if (after.key <= before.key || after.time <= before.time) continue;
    const std::uint64_t keys = distance(before.key, after.key);
    const std::uint64_t time = distance(before.time, after.time);
    if (time % keys != 0) continue;
    if (const auto period = static_cast<std::int64_t>(time / keys); period > 0) ++periods[period];
  }
  if (periods.empty()) return std::nullopt;
  Line line{commonest(periods), 0};
  std::map<std::uint64_t, std::int64_t> offsets;
  for (const EventHead& each : channel) {
    ++offsets[static_cast<std::uint64_t>(each.time) - static_cast<std::uint64_t>(line.period) * static_cast<std::uint64_t>(each.key)];
  }
  line.offset = commonest(offsets);
  if (10 * offsets[line.offset] < 9 * static_cast<std::int64_t>(channel.size())) return std::nullopt;
  return line;
}

// Which messages stay if those go that spoil the order: by time, the longest row whose keys do not fall.
std::vector<bool> in_order(const Heads& channel) {
  std::vector<std::size_t> by_time(channel.size());
  for (std::size_t i = 0; i < by_time.size(); ++i) by_time[i] = i;
  std::stable_sort(by_time.begin(), by_time.end(), [&](std::size_t a, std::size_t b) {
    return channel[a].time < channel[b].time;
  });
  const auto key = [&](std::size_t i) { return channel[i].key; };
  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> ends;  // ends[n]: the last of the row of n + 1 messages that ends lowest
  std::vector<std::size_t> before(channel.size(), kNone);
  for (const std::size_t i : by_time) {
    const auto place = std::upper_bound(ends.begin(), ends.end(), key(i), [&](std::int64_t value, std::size_t end) { return value < key(end); });
    if (place != ends.begin()) before[i] = *std::prev(place);
    if (place == ends.end()) {
      ends.push_back(i);
    } else {
      *place = i;
    }
  }
  std::vector<bool> stays(channel.size(), false);
  for (std::size_t i = ends.empty() ? kNone : ends.back(); i != kNone; i = before[i]) stays[i] = true;
  return stays;
}

// Takes out of the channel what is at odds with the rest of it.
void drop_strays(Heads& channel, bool is_operator, const std::optional<Line>& known_line, LeftOut& left_out) {
  const auto agreeing = [&](const Line& line) {
    return std::count_if(channel.begin(), channel.end(), [&](const EventHead& each) { return line.holds(each.key, each.time); });
  };
  std::optional<Line> line = known_line;
  if (line && 2 * agreeing(*line) <= static_cast<std::ptrdiff_t>(channel.size())) line.reset();
  if (!line && !is_operator) line = line_of(channel);  // an operator moves when he likes
  std::vector<bool> stays;
  if (line) {
    for (const EventHead& each : channel) stays.push_back(line->holds(each.key, each.time));
  } else {
    stays = in_order(channel);
    const auto strays = static_cast<std::size_t>(std::count(stays.begin(), stays.end(), false));
    if (strays > 1 && 100 * strays > channel.size()) stays.assign(channel.size(), true);
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < channel.size(); ++i) {
    if (!stays[i]) {
      left_out.add(channel[i].offset);
    } else {
      channel[kept++] = channel[i];
    }
  }
  channel.resize(kept);
}

void put_in_order(Heads& heads, std::string_view channel, std::vector<std::string>& remarks) {
  const auto earlier = [](const EventHead& a, const EventHead& b) { return a.key < b.key; };
  const bool sorted = std::is_sorted(heads.begin(), heads.end(), earlier);
  if (!sorted) std::stable_sort(heads.begin(), heads.end(), earlier);
  const auto end = std::unique(heads.begin(), heads.end(), [](const EventHead& a, const EventHead& b) { return a.key == b.key; });
  const std::int64_t repeated = heads.end() - end;
  heads.erase(end, heads.end());
  if (heads.empty()) return;
  describe_order(channel, sorted, repeated, static_cast<std::int64_t>(heads.size()), heads.front().key, heads.back().key, remarks);
}

// The runs of one pair, in the order of the file; `begins` takes the offset at which each begins.
void add_runs(Sorting& sorting, Group& group, const std::filesystem::path& path, RunOrder& order, std::vector<std::int64_t>& begins) {
  std::set<std::int64_t> leapt;
  const std::vector<Segment> segments = segments_of(anchors_of(group), leapt);
  refuse_pieces(segments, path);
  std::vector<Group> parts(segments.size());
  for (const Segment& segment : segments) begins.push_back(segment.anchors.empty() ? 0 : segment.anchors.front().offset);
  if (segments.size() == 1 && leapt.empty()) {
    parts[0].channels = std::move(group.channels);
  } else {
    for (std::size_t c = 0; c < kChannels; ++c) {
      for (const EventHead& each : group.channels[c]) {
        if (leapt.contains(each.offset)) {
          sorting.unused.strays[c].add(each.offset);
          continue;
        }
        parts[segment_at(segments, each.offset, each.time)].channels[c].push_back(each);
      }
      group.channels[c] = Heads();
    }
  }
  for (Group& part : parts) {
    std::size_t messages = 0;
    const std::optional<Line> cycles = line_of(part.channels[kEncoderIndex]);  // answers carry the time of the ENCODER they answer
    for (std::size_t c = 0; c < kChannels; ++c) {
      const WireMessage& wire = wire_messages()[c];
      LeftOut left_out;
      drop_strays(part.channels[c], c == kOperatorIndex, wire.is_answer ? cycles : std::nullopt, left_out);
      if (left_out.count > 0) {
        LeftOut& strays = sorting.unused.strays[c];
        if (strays.count == 0) strays.offset = left_out.offset;
        strays.count += left_out.count;
      }
      messages += part.channels[c].size();
      put_in_order(part.channels[c], wire.channel, order.remarks);
    }
    order.runs.push_back({group.configuration_hash, group.run_identity, std::move(part.channels), messages});
  }
}

std::string places(const LeftOut& left_out) {
  return (left_out.count > 1 ? ", the first at byte " : ", at byte ") + std::to_string(left_out.offset);
}

// The channels in the order of their names, in which people are told of them.
std::vector<std::size_t> by_name() {
  std::vector<std::size_t> channels(kChannels);
  for (std::size_t c = 0; c < kChannels; ++c) channels[c] = c;
  std::sort(channels.begin(), channels.end(), [](std::size_t a, std::size_t b) { return wire_messages()[a].channel < wire_messages()[b].channel; });
  return channels;
}

// A machine, a controller or a scenario of its own makes a run's configuration another one; which of them, the hash does not tell.
void tell_configurations(RunOrder& order) {
  for (std::size_t r = 1; r < order.runs.size(); ++r) {
    if (order.runs[r].configuration_hash == order.runs[0].configuration_hash) continue;
    order.remarks.push_back("run " + std::to_string(r + 1) + " of the file has configuration " + hash_text(order.runs[r].configuration_hash) +
                            ", run 1 has " + hash_text(order.runs[0].configuration_hash) +
                            ": another machine, controller or scenario; runs of different machines belong in files of their own");
  }
}

}  // namespace

void Unused::add_foreign(std::string_view channel) {
  const auto known = foreign.find(channel);
  if (known != foreign.end()) {
    ++known->second;
  } else if (foreign.size() < kMostForeign) {
    foreign.emplace(channel, 1);
  } else {
    ++further_foreign;
  }
}

std::vector<std::string> describe(const Unused& unused, const LogDamage& damage) {
  std::vector<std::string> remarks = describe(damage);
  const auto name = [](std::size_t c) { return std::string(wire_messages()[c].channel); };
  for (const std::size_t c : by_name()) {
    const LeftOut& undecodable = unused.undecodable[c];
    if (undecodable.count == 0) continue;
    remarks.push_back(name(c) + ": " + std::to_string(undecodable.count) + " messages could not be decoded (last: " +
                      to_string(unused.last_status[c]) + ")" + places(undecodable));
  }
  int told = 0;
  std::int64_t untold = unused.further_foreign;
  for (const auto& [channel, count] : unused.foreign) {
    if (++told > kForeignChannels) {
      untold += count;
    } else {
      remarks.push_back("channel " + printable_channel(channel) + " is not slewlab's: " + std::to_string(count) +
                        " events left out");
    }
  }
  if (untold > 0) remarks.push_back("further channels are not slewlab's: " + std::to_string(untold) + " events left out");
  const auto tell = [&](const std::array<LeftOut, kChannels>& by_channel, const char* what) {
    for (const std::size_t c : by_name()) {
      const LeftOut& left_out = by_channel[c];
      if (left_out.count == 0) continue;
      remarks.push_back(name(c) + ": " + std::to_string(left_out.count) + " messages " + what + " left out" + places(left_out));
    }
  };
  tell(unused.other_counts, "whose arrays are of another length than those of the others");
  tell(unused.other_runs, "of another run or configuration");
  tell(unused.strays, "whose time or sequence number is at odds with the others");
  return remarks;
}

void describe_order(std::string_view channel, bool sorted, std::int64_t repeated, std::int64_t count, std::int64_t first_key,
                    std::int64_t last_key, std::vector<std::string>& remarks) {
  const std::string name(channel);
  if (!sorted) remarks.push_back(name + ": out of order in the file, sorted by sequence number");
  if (repeated > 0) remarks.push_back(name + ": " + std::to_string(repeated) + " repeated messages left out");
  const std::uint64_t span = distance(first_key, last_key) + 1;
  const std::uint64_t missing = span - static_cast<std::uint64_t>(count);
  if (missing > 0) {
    remarks.push_back(name + ": " + std::to_string(missing) + " of " + std::to_string(span) + " messages are missing");
  }
}

RunOrder order_runs(const std::filesystem::path& path, const AskedCounts& asked) {
  RunOrder order;
  Sorting sorting;
  LogReader reader(path);
  LogEvent event;
  while (reader.next(event)) {
    const std::optional<std::size_t> channel = channel_index(event.channel);
    if (!channel) {
      sorting.unused.add_foreign(event.channel);
      continue;
    }
    const WireMessage& wire = wire_messages()[*channel];
    ArrayCounts counts;
    const DecodeStatus status = check(event.data, wire.fingerprint, wire.pieces, counts);
    if (status != DecodeStatus::ok) {
      sorting.unused.undecodable[*channel].add(event.offset);
      sorting.unused.last_status[*channel] = status;
      continue;
    }
    if (asked[*channel] && *asked[*channel] != counts) {
      sorting.unused.other_counts[*channel].add(event.offset);
      continue;
    }
    const WireHead head = head_of(event.data, wire);
    const auto [known, is_new] = sorting.group_of.try_emplace({head.configuration_hash, head.run_identity}, sorting.groups.size());
    if (is_new) {
      sorting.groups.emplace_back();
      sorting.groups.back().configuration_hash = head.configuration_hash;
      sorting.groups.back().run_identity = head.run_identity;
    }
    sorting.groups[known->second].channels[*channel].push_back({event.offset, head.simulated_time, head.key});
  }

  std::size_t largest = 0;
  bool any_run = false;
  for (std::size_t g = 0; g < sorting.groups.size(); ++g) {
    any_run = any_run || is_run(sorting.groups[g]);
    if (size_of(sorting.groups[g]) > size_of(sorting.groups[largest])) largest = g;
  }
  std::vector<std::int64_t> begins;
  for (std::size_t g = 0; g < sorting.groups.size(); ++g) {
    if (any_run ? is_run(sorting.groups[g]) : g == largest) {
      add_runs(sorting, sorting.groups[g], path, order, begins);
      continue;
    }
    for (std::size_t c = 0; c < kChannels; ++c) {
      for (const EventHead& each : sorting.groups[g].channels[c]) sorting.unused.other_runs[c].add(each.offset);
    }
  }
  const std::vector<std::string> remarks = describe(sorting.unused, reader.damage());
  order.remarks.insert(order.remarks.begin(), remarks.begin(), remarks.end());
  order.lost_bytes = reader.damage().skipped_bytes + reader.damage().cut_off_bytes;
  for (const std::size_t c : kPlantIndices) {
    order.lost_messages += sorting.unused.undecodable[c].count + sorting.unused.other_runs[c].count + sorting.unused.strays[c].count;
  }
  order.lost_messages += sorting.unused.undecodable[kOperatorIndex].count + sorting.unused.other_runs[kOperatorIndex].count +
                         sorting.unused.strays[kOperatorIndex].count;
  if (order.runs.empty()) throw_no_message(path, order.remarks);
  std::vector<std::size_t> places_in_file(order.runs.size());
  for (std::size_t i = 0; i < places_in_file.size(); ++i) places_in_file[i] = i;
  std::stable_sort(places_in_file.begin(), places_in_file.end(), [&](std::size_t a, std::size_t b) { return begins[a] < begins[b]; });
  std::vector<OrderedRun> runs;
  for (const std::size_t i : places_in_file) runs.push_back(std::move(order.runs[i]));
  order.runs = std::move(runs);
  tell_configurations(order);
  return order;
}

void throw_no_message(const std::filesystem::path& path, const std::vector<std::string>& remarks) {
  std::string text = "the log " + path.string() + " holds no message that slewlab can read";
  for (const std::string& remark : remarks) text += "; " + remark;
  throw LogError(text);
}

EventsAt::EventsAt(const std::filesystem::path& path)
    : path_(path), file_(std::fopen(path.c_str(), "rb")), window_(kWindowBytes) {
  if (!file_) throw LogError("cannot read the log " + path.string() + ": " + std::strerror(errno));
}

bool EventsAt::have(std::int64_t offset, std::size_t bytes) {
  if (offset >= begin_ && offset + static_cast<std::int64_t>(bytes) <= begin_ + static_cast<std::int64_t>(filled_)) return true;
  if (window_.size() < bytes) window_.resize(bytes);
  begin_ = offset;
  filled_ = 0;
  if (::fseeko(file_.get(), static_cast<off_t>(offset), SEEK_SET) == 0) {
    filled_ = std::fread(window_.data(), 1, window_.size(), file_.get());
  }
  return filled_ >= bytes;
}

LogEvent EventsAt::event(std::int64_t offset) {
  const auto at = [&] { return window_.data() + (offset - begin_); };
  if (have(offset, kLogEventHeadBytes)) {
    const EventLengths lengths = event_lengths(at());
    const std::size_t whole = kLogEventHeadBytes + lengths.channel + lengths.data;
    if (lengths.channel > 0 && have(offset, whole)) return event_of(at(), lengths, offset);
  }
  throw LogError("the log " + path_.string() + " changed while it was read: there is no event at byte " + std::to_string(offset) + " any more");
}

}  // namespace slewlab::msgs
