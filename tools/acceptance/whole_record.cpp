#include "tools/acceptance/whole_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
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

// The name and the time of a number that is not finite; `read` gives a message's numbers, in the order of `names`. A column
// without any number is not fitted, where `may_be_missing`. Messages from `until` [ns] on are not looked at.
template <class Message, std::size_t kCount>
std::string why_not_finite(const std::vector<Message>& messages, const char* channel, const std::array<const char*, kCount>& names,
                           bool may_be_missing, const auto& read, std::int64_t until = kNever) {
  std::array<bool, kCount> all_missing;
  all_missing.fill(may_be_missing);
  if (may_be_missing) {
    for (const Message& message : messages) {
      const std::array<double, kCount> values = read(message);
      for (std::size_t i = 0; i < kCount; ++i) all_missing[i] = all_missing[i] && std::isnan(values[i]);
    }
  }
  for (const Message& message : messages) {
    if (message.simulated_time >= until) continue;
    const std::array<double, kCount> values = read(message);
    for (std::size_t i = 0; i < kCount; ++i) {
      if (std::isfinite(values[i]) || all_missing[i]) continue;
      return fmt::format("{} of {} is {} at {:.3f} s, expected a finite number", names[i], channel, values[i], seconds(message.simulated_time));
    }
  }
  return {};
}

// One number for an array: the first that is not finite, or 0.
double worst(const std::vector<double>& values) {
  const auto found = std::find_if(values.begin(), values.end(), [](double value) { return !std::isfinite(value); });
  return found == values.end() ? 0.0 : *found;
}

std::string why_not_finite(const msgs::RunLog& run, std::int64_t until_fault, std::int64_t until_trip) {
  std::string why = why_not_finite(run.encoder, "ENCODER", std::array{"shaft_speed", "shaft_position"}, false,
                                   [](const msgs::Encoder& message) { return std::array{worst(message.shaft_speed), worst(message.shaft_position)}; }, until_fault);
  if (!why.empty()) return why;
  why = why_not_finite(run.torque, "TORQUE", std::array{"motor_torque"}, false,
                       [](const msgs::Torque& message) { return std::array{worst(message.motor_torque)}; }, std::min(until_fault, until_trip));
  if (!why.empty()) return why;
  why = why_not_finite(run.operator_moves, "OPERATOR", std::array{"speed_request"}, false,
                       [](const msgs::Operator& message) { return std::array{message.speed_request}; });
  if (!why.empty()) return why;
  why = why_not_finite(run.sensors, "SENSORS",
                       std::array{"house_acceleration", "pivot_acceleration", "middle_acceleration", "tip_acceleration", "slew_angle"}, true,
                       [](const msgs::Sensors& message) {
                         return std::array{message.house_acceleration, message.pivot_acceleration, message.middle_acceleration,
                                           message.tip_acceleration, message.slew_angle};
                       });
  if (!why.empty()) return why;
  return why_not_finite(run.truth, "TRUTH",
                        std::array{"gearbox_torque", "gear_deflection", "house_speed", "tip_displacement", "tip_velocity", "rope_angle", "rod_angle",
                                   "mechanical_energy", "supplied_work", "shear_force", "modal_energy"},
                        true, [](const msgs::Truth& message) {
                          return std::array{worst(message.gearbox_torque), worst(message.gear_deflection), message.house_speed, message.tip_displacement,
                                            message.tip_velocity, message.rope_angle, message.rod_angle, message.mechanical_energy,
                                            message.supplied_work, worst(message.shear_force), worst(message.modal_energy)};
                        });
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
