#include "msgs/run_log.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <type_traits>
#include <utility>

namespace slewlab::msgs {
namespace {

constexpr std::uint64_t kFallBack = 1'000'000'000;  // [ns] that messages may be out of order in the file
constexpr std::uint64_t kLeap = 1'000'000'000;      // [ns] ahead, or some of the usual distances
constexpr std::uint64_t kUsualDistances = 4;        // chosen: a message or two may be missing without a leap
constexpr int kForeignChannels = 10;                // told by name

// For any numbers that a damaged message may hold.
std::uint64_t distance(std::int64_t from, std::int64_t to) {
  return static_cast<std::uint64_t>(to) - static_cast<std::uint64_t>(from);
}
std::uint64_t size_of_difference(std::int64_t a, std::int64_t b) { return a < b ? distance(a, b) : distance(b, a); }

template <class Message>
struct Placed {
  std::int64_t offset = 0;  // [bytes] in the file
  Message message;
};
template <class Message>
using Channel = std::vector<Placed<Message>>;

// Everything that carries one pair of configuration and run, in the order of the file.
struct Group {
  std::int64_t configuration_hash = 0;
  std::int64_t run_identity = 0;
  Channel<Encoder> encoder;
  Channel<Torque> torque;
  Channel<Operator> operator_moves;
  Channel<Sensors> sensors;
  Channel<Truth> truth;
  Channel<ControllerState> controller_state;
  Channel<PlantStatus> plant_status;
};

// Calls visit(name, channel of the group, channel of a run).
template <class Visit>
void for_every_channel(Visit visit) {
  visit(kEncoderChannel, &Group::encoder, &RunLog::encoder);
  visit(kTorqueChannel, &Group::torque, &RunLog::torque);
  visit(kOperatorChannel, &Group::operator_moves, &RunLog::operator_moves);
  visit(kSensorsChannel, &Group::sensors, &RunLog::sensors);
  visit(kTruthChannel, &Group::truth, &RunLog::truth);
  visit(kControllerStateChannel, &Group::controller_state, &RunLog::controller_state);
  visit(kPlantStatusChannel, &Group::plant_status, &RunLog::plant_status);
}

// What was left out of a channel, and where that begins.
struct LeftOut {
  std::int64_t count = 0;
  std::int64_t offset = 0;  // [bytes] of the first
  void add(std::int64_t at) {
    if (count++ == 0) offset = at;
  }
};

struct Unusable {
  LeftOut left_out;
  DecodeStatus status = DecodeStatus::ok;
};

struct Sorting {
  std::vector<Group> groups;  // in the order in which they begin in the file
  std::map<std::pair<std::int64_t, std::int64_t>, std::size_t> group_of;
  std::map<std::string, Unusable> unusable;        // by channel
  std::map<std::string, std::int64_t> foreign;     // channels that are not slewlab's
  std::map<std::string, LeftOut> other_runs;       // by channel: of no run of this file
  std::map<std::string, LeftOut> strays;           // by channel: at odds with their run
};

template <class Message>
void take(Sorting& sorting, const LogEvent& event, Channel<Message> Group::*channel) {
  Placed<Message> placed;
  placed.offset = event.offset;
  const DecodeStatus status = decode(event.data, placed.message);
  if (status != DecodeStatus::ok) {
    Unusable& unusable = sorting.unusable[std::string(event.channel)];
    unusable.left_out.add(event.offset);
    unusable.status = status;
    return;
  }
  const Message& message = placed.message;
  const auto [known, is_new] =
      sorting.group_of.try_emplace({message.configuration_hash, message.run_identity}, sorting.groups.size());
  if (is_new) {
    sorting.groups.emplace_back();
    sorting.groups.back().configuration_hash = message.configuration_hash;
    sorting.groups.back().run_identity = message.run_identity;
  }
  (sorting.groups[known->second].*channel).push_back(std::move(placed));
}

// A message of the plant, as far as it tells which run the file is in.
struct Anchor {
  std::int64_t offset = 0;
  std::int64_t time = 0;  // [ns]
  std::int64_t sequence = 0;
  bool same_message(const Anchor& other) const { return sequence == other.sequence && time == other.time; }
};

template <class Message>
std::vector<Anchor> anchors_of(const Channel<Message>& channel) {
  std::vector<Anchor> anchors;
  for (const auto& placed : channel) anchors.push_back({placed.offset, placed.message.simulated_time, placed.message.sequence});
  return anchors;
}

bool differ(const std::vector<Anchor>& anchors) {
  return std::any_of(anchors.begin(), anchors.end(), [&](const Anchor& anchor) { return !anchor.same_message(anchors.front()); });
}

// The messages that tell the runs of the group apart, in the order of the file.
std::vector<Anchor> anchors_of(const Group& group) {
  std::vector<Anchor> best = anchors_of(group.encoder);
  if (differ(best)) return best;
  for (std::vector<Anchor> other : {anchors_of(group.sensors), anchors_of(group.truth), anchors_of(group.plant_status)}) {
    if (other.size() > best.size()) best = std::move(other);
  }
  return best;
}

bool is_run(const Group& group) {
  const bool one_says_it = differ(anchors_of(group));
  const std::size_t channels = !group.encoder.empty() + !group.sensors.empty() + !group.truth.empty() + !group.plant_status.empty();
  return one_says_it || channels > 1;
}

std::size_t size_of(const Group& group) {
  std::size_t size = 0;
  for_every_channel([&](const char*, auto channel, auto) { size += (group.*channel).size(); });
  return size;
}

// [ns] beyond which simulated time leaps ahead.
std::uint64_t leap_of(const std::vector<Anchor>& anchors) {
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
  std::vector<Anchor> anchors;
};

// The runs of one pair; `strays` takes the offsets of the messages that leap and do not go on.
std::vector<Segment> segments_of(const std::vector<Anchor>& anchors, std::set<std::int64_t>& strays) {
  const std::uint64_t leap = leap_of(anchors);
  const auto goes_on = [&](const Anchor& from, const Anchor& to) {
    return to.time < from.time ? distance(to.time, from.time) <= kFallBack : distance(from.time, to.time) <= leap;
  };
  std::vector<Segment> segments;
  std::vector<Anchor> leapt;  // messages that agree with each other, but not yet a run
  const auto give_up = [&] {
    for (const Anchor& anchor : leapt) strays.insert(anchor.offset);
    leapt.clear();
  };
  for (const Anchor& anchor : anchors) {
    const bool on_run = !segments.empty() && goes_on(segments.back().anchors.back(), anchor);
    const bool on_leapt = !leapt.empty() && goes_on(leapt.back(), anchor);
    if (on_run && !(on_leapt && anchor.time < segments.back().anchors.back().time)) {
      give_up();
      segments.back().anchors.push_back(anchor);
      continue;
    }
    if (!on_leapt) give_up();
    leapt.push_back(anchor);
    if (leapt.front().same_message(anchor)) continue;
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

// An answer counts by the ENCODER it answers: a controller that was started anew counts its own messages from 0 again.
template <class Message>
std::int64_t key_of(const Message& message) {
  if constexpr (requires { message.answered_sequence; }) return message.answered_sequence;
  else return message.sequence;
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
template <class Message>
std::optional<Line> line_of(const Channel<Message>& channel) {
  std::map<std::int64_t, std::int64_t> periods;
  for (std::size_t i = 1; i < channel.size(); ++i) {
    const Message& before = channel[i - 1].message;
    const Message& after = channel[i].message;
    const std::uint64_t keys = distance(key_of(before), key_of(after));
    const std::uint64_t time = distance(before.simulated_time, after.simulated_time);
    if (key_of(after) <= key_of(before) || after.simulated_time <= before.simulated_time || time % keys != 0) continue;
    if (const auto period = static_cast<std::int64_t>(time / keys); period > 0) ++periods[period];
  }
  if (periods.empty()) return std::nullopt;
  Line line{commonest(periods), 0};
  std::map<std::uint64_t, std::int64_t> offsets;
  for (const auto& placed : channel) {
    ++offsets[static_cast<std::uint64_t>(placed.message.simulated_time) -
              static_cast<std::uint64_t>(line.period) * static_cast<std::uint64_t>(key_of(placed.message))];
  }
  line.offset = commonest(offsets);
  if (10 * offsets[line.offset] < 9 * static_cast<std::int64_t>(channel.size())) return std::nullopt;
  return line;
}

// Which messages stay if those go that spoil the order: by time, the longest row whose keys do not fall.
template <class Message>
std::vector<bool> in_order(const Channel<Message>& channel) {
  std::vector<std::size_t> by_time(channel.size());
  for (std::size_t i = 0; i < by_time.size(); ++i) by_time[i] = i;
  std::stable_sort(by_time.begin(), by_time.end(), [&](std::size_t a, std::size_t b) {
    return channel[a].message.simulated_time < channel[b].message.simulated_time;
  });
  const auto key = [&](std::size_t i) { return key_of(channel[i].message); };
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
template <class Message>
void drop_strays(Channel<Message>& channel, const std::optional<Line>& known_line, LeftOut& left_out) {
  const auto agreeing = [&](const Line& line) {
    return std::count_if(channel.begin(), channel.end(), [&](const auto& placed) {
      return line.holds(key_of(placed.message), placed.message.simulated_time);
    });
  };
  std::optional<Line> line = known_line;
  if (line && 2 * agreeing(*line) <= static_cast<std::ptrdiff_t>(channel.size())) line.reset();
  if (!line && !std::is_same_v<Message, Operator>) line = line_of(channel);  // an operator moves when he likes
  std::vector<bool> stays;
  if (line) {
    for (const auto& placed : channel) stays.push_back(line->holds(key_of(placed.message), placed.message.simulated_time));
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
      if (kept != i) channel[kept] = std::move(channel[i]);
      ++kept;
    }
  }
  channel.resize(kept);
}

template <class Message>
std::vector<Message> put_in_order(Channel<Message>& placed, const char* channel, std::vector<std::string>& remarks) {
  std::vector<Message> messages;
  messages.reserve(placed.size());
  for (auto& each : placed) messages.push_back(std::move(each.message));
  const auto earlier = [](const Message& a, const Message& b) { return key_of(a) < key_of(b); };
  const auto same = [](const Message& a, const Message& b) { return key_of(a) == key_of(b); };
  if (!std::is_sorted(messages.begin(), messages.end(), earlier)) {
    remarks.push_back(std::string(channel) + ": out of order in the file, sorted by sequence number");
    std::stable_sort(messages.begin(), messages.end(), earlier);
  }
  const auto end = std::unique(messages.begin(), messages.end(), same);
  if (end != messages.end()) {
    remarks.push_back(std::string(channel) + ": " + std::to_string(messages.end() - end) +
                      " repeated messages left out");
    messages.erase(end, messages.end());
  }
  if (messages.empty()) return messages;
  const std::uint64_t span = distance(key_of(messages.front()), key_of(messages.back())) + 1;
  const std::uint64_t missing = span - messages.size();
  if (missing > 0) {
    remarks.push_back(std::string(channel) + ": " + std::to_string(missing) + " of " + std::to_string(span) +
                      " messages are missing");
  }
  return messages;
}

// The runs of one pair, in the order of the file; `begins` takes the offset at which each begins.
void add_runs(Sorting& sorting, Group& group, RunLogs& logs, std::vector<std::int64_t>& begins) {
  std::set<std::int64_t> leapt;
  const std::vector<Segment> segments = segments_of(anchors_of(group), leapt);
  std::vector<Group> parts(segments.size());
  for_every_channel([&](const char* name, auto channel, auto) {
    for (auto& placed : group.*channel) {
      if (leapt.contains(placed.offset)) {
        sorting.strays[name].add(placed.offset);
        continue;
      }
      const std::size_t part = segment_at(segments, placed.offset, placed.message.simulated_time);
      (parts[part].*channel).push_back(std::move(placed));
    }
  });
  for (std::size_t s = 0; s < parts.size(); ++s) {
    Group& part = parts[s];
    RunLog run;
    run.configuration_hash = group.configuration_hash;
    run.run_identity = group.run_identity;
    const std::optional<Line> cycles = line_of(part.encoder);  // answers carry the time of the ENCODER they answer
    for_every_channel([&](const char* name, auto channel, auto of_run) {
      using Message = typename std::decay_t<decltype(part.*channel)>::value_type;
      const bool is_answer = requires(Message message) { message.message.answered_sequence; };
      LeftOut left_out;
      drop_strays(part.*channel, is_answer ? cycles : std::nullopt, left_out);
      if (left_out.count > 0) {
        LeftOut& strays = sorting.strays[name];
        if (strays.count == 0) strays.offset = left_out.offset;
        strays.count += left_out.count;
      }
      run.*of_run = put_in_order(part.*channel, name, logs.remarks);
    });
    begins.push_back(segments[s].anchors.empty() ? 0 : segments[s].anchors.front().offset);
    logs.runs.push_back(std::move(run));
  }
}

bool is_of_the_plant(const std::string& channel) {
  return channel != kTorqueChannel && channel != kControllerStateChannel;
}

std::string places(const LeftOut& left_out) {
  return (left_out.count > 1 ? ", the first at byte " : ", at byte ") + std::to_string(left_out.offset);
}

void remark(const Sorting& sorting, const LogDamage& damage, RunLogs& logs) {
  std::vector<std::string> remarks = describe(damage);
  logs.lost_bytes = damage.skipped_bytes + damage.cut_off_bytes;
  for (const auto& [channel, unusable] : sorting.unusable) {
    remarks.push_back(channel + ": " + std::to_string(unusable.left_out.count) + " messages could not be decoded (last: " +
                      to_string(unusable.status) + ")" + places(unusable.left_out));
    if (is_of_the_plant(channel)) logs.lost_messages += unusable.left_out.count;
  }
  int told = 0;
  std::int64_t untold = 0;
  for (const auto& [channel, count] : sorting.foreign) {
    if (++told > kForeignChannels) {
      untold += count;
    } else {
      remarks.push_back("channel " + printable_channel(channel) + " is not slewlab's: " + std::to_string(count) +
                        " events left out");
    }
  }
  if (untold > 0) remarks.push_back("further channels are not slewlab's: " + std::to_string(untold) + " events left out");
  const auto tell = [&](const std::map<std::string, LeftOut>& by_channel, const char* what) {
    for (const auto& [channel, left_out] : by_channel) {
      remarks.push_back(channel + ": " + std::to_string(left_out.count) + " messages " + what + " left out" + places(left_out));
      if (is_of_the_plant(channel)) logs.lost_messages += left_out.count;
    }
  };
  tell(sorting.other_runs, "of another run or configuration");
  tell(sorting.strays, "whose time or sequence number is at odds with the others");
  logs.remarks.insert(logs.remarks.begin(), remarks.begin(), remarks.end());
}

}  // namespace

RunLogs read_run_logs(const std::filesystem::path& path) {
  RunLogs logs;
  Sorting sorting;
  LogReader reader(path);
  LogEvent event;
  while (reader.next(event)) {
    bool ours = false;
    for_every_channel([&](const char* name, auto channel, auto) {
      if (event.channel != name) return;
      ours = true;
      take(sorting, event, channel);
    });
    if (!ours) ++sorting.foreign[std::string(event.channel)];
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
      add_runs(sorting, sorting.groups[g], logs, begins);
      continue;
    }
    for_every_channel([&](const char* name, auto channel, auto) {
      for (const auto& placed : sorting.groups[g].*channel) sorting.other_runs[name].add(placed.offset);
    });
  }
  remark(sorting, reader.damage(), logs);
  if (logs.runs.empty()) {
    std::string text = "the log " + path.string() + " holds no message that slewlab can read";
    for (const std::string& remark : logs.remarks) text += "; " + remark;
    throw LogError(text);
  }
  std::vector<std::size_t> order(logs.runs.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return begins[a] < begins[b]; });
  std::vector<RunLog> runs;
  for (const std::size_t i : order) runs.push_back(std::move(logs.runs[i]));
  logs.runs = std::move(runs);
  return logs;
}

}  // namespace slewlab::msgs
