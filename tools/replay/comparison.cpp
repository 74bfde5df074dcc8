#include "tools/replay/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <ostream>

#include "tools/replay/message_fields.h"

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

// The fields of two messages side by side; what only one of them has (arrays of another length) shows in its count.
template <class Message>
bool compare_messages(const Message& recorded, const Message& replayed, ChannelComparison& result) {
  std::vector<FieldValue> before;
  visit_compared(recorded, [&](const FieldValue& field) { before.push_back(field); });
  bool same = true;
  visit_compared(replayed, [&](const FieldValue& after) {
    const auto like = std::find_if(before.begin(), before.end(), [&](const FieldValue& field) {
      return field.index == after.index && field.name == std::string_view(after.name);
    });
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

template <class Message>
ChannelComparison compare_channel(const char* channel, const std::vector<Message>& recorded,
                                  const std::vector<Message>& replayed) {
  ChannelComparison result;
  result.channel = channel;
  std::map<std::int64_t, const Message*> waiting;
  for (const Message& message : replayed) waiting.emplace(key_of(message), &message);
  for (const Message& message : recorded) {
    const auto like = waiting.find(key_of(message));
    if (like == waiting.end()) {
      ++result.only_recorded;
      continue;
    }
    ++result.compared;
    if (!compare_messages(message, *like->second, result)) ++result.differing;
    waiting.erase(like);
  }
  result.only_replayed = static_cast<std::int64_t>(waiting.size());
  return result;
}

std::string with_unit(double value, const std::string& unit) {
  return fmt::format("{:.9g}{}", value, unit == "-" ? "" : " " + unit);
}

}  // namespace

ChannelComparison compare(const std::vector<msgs::Encoder>& recorded, const std::vector<msgs::Encoder>& replayed) {
  return compare_channel(msgs::kEncoderChannel, recorded, replayed);
}
ChannelComparison compare(const std::vector<msgs::Sensors>& recorded, const std::vector<msgs::Sensors>& replayed) {
  return compare_channel(msgs::kSensorsChannel, recorded, replayed);
}
ChannelComparison compare(const std::vector<msgs::Truth>& recorded, const std::vector<msgs::Truth>& replayed) {
  return compare_channel(msgs::kTruthChannel, recorded, replayed);
}
ChannelComparison compare(const std::vector<msgs::PlantStatus>& recorded,
                          const std::vector<msgs::PlantStatus>& replayed) {
  return compare_channel(msgs::kPlantStatusChannel, recorded, replayed);
}
ChannelComparison compare(const std::vector<msgs::Torque>& recorded, const std::vector<msgs::Torque>& replayed) {
  return compare_channel(msgs::kTorqueChannel, recorded, replayed);
}
ChannelComparison compare(const std::vector<msgs::ControllerState>& recorded,
                          const std::vector<msgs::ControllerState>& replayed) {
  return compare_channel(msgs::kControllerStateChannel, recorded, replayed);
}

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
