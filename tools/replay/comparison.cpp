#include "tools/replay/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <ostream>
#include <utility>

namespace slewlab::tools {
namespace {

constexpr double kNanosecondsPerSecond = 1e9;

std::string name_of(const FieldValue& field) {
  return field.index < 0 ? field.name : fmt::format("{}[{}]", field.name, field.index);
}

double size_of_difference(double recorded, double replayed) {
  const double size = std::abs(replayed - recorded);
  return std::isfinite(size) ? size : std::numeric_limits<double>::infinity();
}

// The fields of two messages side by side; what only one of them has (arrays of another length) shows in its count. `before`
// is memory that is used again.
template <class Message>
bool compare_messages(const Message& recorded, const Message& replayed, std::vector<FieldValue>& before, ChannelComparison& result) {
  before.clear();
  visit_compared(recorded, [&](const FieldValue& field) { before.push_back(field); });
  bool same = true;
  std::size_t place = 0;  // the same field's as long as all arrays have the same lengths
  visit_compared(replayed, [&](const FieldValue& after) {
    const auto is_like = [&](const FieldValue& field) { return field.index == after.index && field.name == std::string_view(after.name); };
    const auto here = before.begin() + static_cast<std::ptrdiff_t>(std::min(place++, before.size()));
    const auto like = here != before.end() && is_like(*here) ? here : std::find_if(before.begin(), before.end(), is_like);
    if (like == before.end() || like->bits == after.bits) return;
    same = false;
    const std::string name = name_of(after);
    auto known = std::find_if(result.differences.begin(), result.differences.end(),
                              [&](const FieldDifference& difference) { return difference.field == name; });
    if (known == result.differences.end()) {
      FieldDifference first;
      first.channel = result.channel;
      first.field = name;
      first.unit = after.unit;
      first.largest = -1.0;
      first.first_time = recorded.simulated_time;
      first.first_key = key_of(recorded);
      first.first_recorded = like->value;
      first.first_replayed = after.value;
      known = result.differences.insert(result.differences.end(), first);
    }
    ++known->count;
    const double size = size_of_difference(like->value, after.value);
    if (size > known->largest) {
      known->largest = size;
      known->largest_time = recorded.simulated_time;
    }
  });
  return same;
}

std::string with_unit(double value, const std::string& unit) {
  return fmt::format("{:.9g}{}", value, unit == "-" ? "" : " " + unit);
}

}  // namespace

template <class Message>
void RunningComparison<Message>::add(const Message& replayed) {
  const std::int64_t key = key_of(replayed);
  for (; recorded_.current() != nullptr && key_of(*recorded_.current()) < key; recorded_.advance()) ++result_.only_recorded;
  if (recorded_.current() == nullptr || key_of(*recorded_.current()) != key) {
    ++result_.only_replayed;
    return;
  }
  const std::int64_t time = recorded_.current()->simulated_time;
  if (result_.compared++ == 0) result_.first_time = result_.last_time = time;
  result_.last_time = std::max(result_.last_time, time);
  if (!compare_messages(*recorded_.current(), replayed, fields_, result_)) ++result_.differing;
  recorded_.advance();
}

template <class Message>
ChannelComparison RunningComparison<Message>::finish() {
  for (; recorded_.current() != nullptr; recorded_.advance()) ++result_.only_recorded;
  return std::move(result_);
}

template class RunningComparison<msgs::Encoder>;
template class RunningComparison<msgs::Sensors>;
template class RunningComparison<msgs::Truth>;
template class RunningComparison<msgs::PlantStatus>;
template class RunningComparison<msgs::Torque>;
template class RunningComparison<msgs::ControllerState>;

const FieldDifference* first_difference(const std::vector<ChannelComparison>& channels) {
  const FieldDifference* first = nullptr;
  for (const ChannelComparison& channel : channels) {
    for (const FieldDifference& difference : channel.differences) {
      if (first == nullptr || difference.first_time < first->first_time) first = &difference;
    }
  }
  return first;
}

bool identical(const std::vector<ChannelComparison>& channels) {
  return std::all_of(channels.begin(), channels.end(),
                     [](const ChannelComparison& channel) { return channel.differing == 0; });
}

std::int64_t compared_messages(const std::vector<ChannelComparison>& channels) {
  std::int64_t sum = 0;
  for (const ChannelComparison& channel : channels) sum += channel.compared;
  return sum;
}

std::string compared_span(const std::vector<ChannelComparison>& channels) {
  std::int64_t first = std::numeric_limits<std::int64_t>::max(), last = std::numeric_limits<std::int64_t>::min();
  std::string without, in_part;
  for (const ChannelComparison& channel : channels) {
    if (channel.compared == 0) {
      without += (without.empty() ? "" : ", ") + channel.channel;
      continue;
    }
    first = std::min(first, channel.first_time);
    last = std::max(last, channel.last_time);
    // A record's end cuts off a few: they are on the channel's own line.
    constexpr std::int64_t kFew = 3, kShare = 100;
    if (channel.only_replayed <= kFew || kShare * channel.only_replayed <= channel.compared) continue;
    in_part += fmt::format("; of {} {} messages are missing, the last compared is that of {:.3f} s", channel.channel, channel.only_replayed,
                           static_cast<double>(channel.last_time) / kNanosecondsPerSecond);
  }
  if (first > last) return {};
  return fmt::format("from {:.3f} s to {:.3f} s", static_cast<double>(first) / kNanosecondsPerSecond, static_cast<double>(last) / kNanosecondsPerSecond) +
         in_part + (without.empty() ? "" : "; of " + without + " nothing was compared");
}

void print(std::ostream& out, const std::vector<ChannelComparison>& channels) {
  for (const ChannelComparison& channel : channels) {
    out << fmt::format("    {:<17} {:>7} compared, ", channel.channel, channel.compared);
    if (channel.compared == 0) {
      out << "nothing to compare";
    } else if (channel.differing == 0) {
      out << "all identical to the bit";
    } else {
      out << fmt::format("{} differ", channel.differing);
    }
    if (channel.only_recorded > 0) out << fmt::format("; {} only recorded", channel.only_recorded);
    if (channel.only_replayed > 0) out << fmt::format("; {} not in the log", channel.only_replayed);
    out << '\n';
  }
  const FieldDifference* first = first_difference(channels);
  if (first == nullptr) return;
  out << fmt::format("    first difference: at {:.4f} s in {} {}, {}: recorded {}, replayed {}, difference {}\n",
                     static_cast<double>(first->first_time) / kNanosecondsPerSecond, first->channel, first->first_key,
                     first->field, with_unit(first->first_recorded, first->unit),
                     with_unit(first->first_replayed, first->unit),
                     with_unit(first->first_replayed - first->first_recorded, first->unit));
  out << fmt::format("    {:<42} {:>14} {:>10} {:>10} {:>9}\n", "field", "largest diff.", "at [s]", "first [s]",
                     "messages");
  for (const ChannelComparison& channel : channels) {
    for (const FieldDifference& difference : channel.differences) {
      out << fmt::format("    {:<42} {:>14.6g} {:>10.4f} {:>10.4f} {:>9}\n",
                         fmt::format("{}.{} [{}]", channel.channel, difference.field, difference.unit),
                         difference.largest, static_cast<double>(difference.largest_time) / kNanosecondsPerSecond,
                         static_cast<double>(difference.first_time) / kNanosecondsPerSecond, difference.count);
    }
  }
}

}  // namespace slewlab::tools
