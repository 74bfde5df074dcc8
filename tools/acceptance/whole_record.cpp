#include "tools/acceptance/whole_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <slewlab_msgs/fields.hpp>
#include <type_traits>
#include <vector>

namespace slewlab::tools {
namespace {

constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();  // [ns]

double seconds(std::int64_t nanoseconds) { return static_cast<double>(nanoseconds) / 1e9; }

// A channel whose messages are due at 0, period, 2 period ... up to `last`.
struct Due {
  const char* channel = "";
  std::int64_t period = 0;  // [ns]
  std::int64_t last = 0;    // [ns]
};

template <class Message>
std::string why_not_every(const std::vector<Message>& messages, const Due& due) {
  if (messages.empty()) return fmt::format("there is no {} in the log, expected one every {:.4g} s", due.channel, seconds(due.period));
  const auto missing = [&](std::int64_t at) {
    return fmt::format("{} of {:.3f} s is missing in the log, expected one every {:.4g} s up to {:.3f} s", due.channel, seconds(at), seconds(due.period),
                       seconds(due.last));
  };
  std::int64_t before = -due.period;
  for (const Message& message : messages) {
    if (message.simulated_time > before + due.period) return missing(before + due.period);
    before = message.simulated_time;
  }
  return before + due.period <= due.last ? missing(before + due.period) : "";
}

constexpr std::size_t kMostNumbers = 32;  // fields of a message that hold numbers

// The numbers of a message by the names of its .lcm file; of an array the first that is not finite, or 0.
struct Numbers {
  std::array<const char*, kMostNumbers> names{};
  std::array<double, kMostNumbers> values{};
  std::size_t count = 0;
};

template <class Message>
Numbers numbers_of(const Message& message) {
  Numbers numbers;
  const auto add = [&](const char* name, double value) {
    numbers.names.at(numbers.count) = name;
    numbers.values.at(numbers.count++) = value;
  };
  msgs::visit_fields(message, [&](const char* name, const char*, const auto& value) {
    using Value = std::decay_t<decltype(value)>;
    if constexpr (std::is_same_v<Value, double>) {
      add(name, value);
    } else if constexpr (std::is_same_v<Value, std::vector<double>>) {
      const auto found = std::find_if(value.begin(), value.end(), [](double each) { return !std::isfinite(each); });
      add(name, found == value.end() ? 0.0 : *found);
    }
  });
  return numbers;
}

// The name and the time of a number that is not finite. A column without any number is not fitted, where `may_be_missing`. Messages from
// `until` [ns] on are not looked at.
template <class Message>
std::string why_not_finite(const std::vector<Message>& messages, const char* channel, bool may_be_missing, std::int64_t until = kNever) {
  std::array<bool, kMostNumbers> all_missing;
  all_missing.fill(may_be_missing);
  if (may_be_missing) {
    for (const Message& message : messages) {
      const Numbers numbers = numbers_of(message);
      for (std::size_t i = 0; i < numbers.count; ++i) all_missing[i] = all_missing[i] && std::isnan(numbers.values[i]);
    }
  }
  for (const Message& message : messages) {
    if (message.simulated_time >= until) continue;
    const Numbers numbers = numbers_of(message);
    for (std::size_t i = 0; i < numbers.count; ++i) {
      if (std::isfinite(numbers.values[i]) || all_missing[i]) continue;
      return fmt::format("{} of {} is {} at {:.3f} s, expected a finite number", numbers.names[i], channel, numbers.values[i], seconds(message.simulated_time));
    }
  }
  return {};
}

std::string why_not_finite(const msgs::RunLog& run, std::int64_t until_fault, std::int64_t until_trip) {
  std::string why = why_not_finite(run.encoder, "ENCODER", false, until_fault);
  if (why.empty()) why = why_not_finite(run.torque, "TORQUE", false, std::min(until_fault, until_trip));
  if (why.empty()) why = why_not_finite(run.operator_moves, "OPERATOR", false);
  if (why.empty()) why = why_not_finite(run.sensors, "SENSORS", true);
  if (why.empty()) why = why_not_finite(run.truth, "TRUTH", true);
  return why;
}

// A TORQUE for every ENCODER before the first fault on purpose.
std::string why_not_answered(const msgs::RunLog& run, std::int64_t until_fault) {
  std::size_t next = 0;
  for (const msgs::Encoder& encoder : run.encoder) {
    if (encoder.simulated_time >= until_fault) break;
    while (next < run.torque.size() && run.torque[next].answered_sequence < encoder.sequence) ++next;
    if (next < run.torque.size() && run.torque[next].answered_sequence == encoder.sequence) continue;
    return fmt::format("there is no TORQUE that answers the ENCODER of {:.3f} s, expected one for every ENCODER", seconds(encoder.simulated_time));
  }
  return {};
}

}  // namespace

std::string why_not_whole(const msgs::RunLog& run, const sim::Scenario& scenario, bool of_own_plant) {
  std::int64_t until_fault = kNever, until_trip = kNever;
  for (const sim::Fault& fault : scenario.faults) until_fault = std::min(until_fault, fault.from);
  for (const msgs::PlantStatus& status : run.plant_status) {
    if (status.trip_time >= 0) until_trip = std::min(until_trip, status.trip_time);
  }
  const std::int64_t end = scenario.duration;
  std::string why = why_not_every(run.encoder, {"ENCODER", scenario.controller_period, end - 1});
  const auto telemetry = [&](const auto& messages, const Due& due) {
    if (why.empty() && !(of_own_plant && messages.empty())) why = why_not_every(messages, due);
  };
  telemetry(run.sensors, {"SENSORS", scenario.sensors_period, end});
  telemetry(run.truth, {"TRUTH", scenario.truth_period, end});
  telemetry(run.plant_status, {"PLANT_STATUS", scenario.status_period, end});
  if (why.empty()) why = why_not_answered(run, until_fault);
  if (why.empty()) why = why_not_finite(run, until_fault, until_trip);
  return why;
}

}  // namespace slewlab::tools
