#include "controller/plausibility.h"

#include <cmath>

namespace slewlab::controller {
namespace {

constexpr double kNanosecond = 1e-9;  // [s]
constexpr double kRounding = 1e-9;    // [-] of a time-out that is a whole number of periods

bool has_signal(const EncoderReading& reading, int group_count) {
  if (reading.group_count != group_count) return false;
  for (int i = 0; i < group_count; ++i) {
    if (!std::isfinite(reading.shaft_speed[i])) return false;
  }
  return true;
}

bool is_in_range(const PlausibilitySettings& settings, const EncoderReading& reading) {
  for (int i = 0; i < reading.group_count; ++i) {
    if (std::fabs(reading.shaft_speed[i]) > settings.speed_limit || !std::isfinite(reading.shaft_position[i])) return false;
  }
  return true;
}

bool can_follow(const PlausibilitySettings& settings, double period, const EncoderReading& last,
                const EncoderReading& reading) {
  // Differences of doubles: what arrives may be any integer, and their difference none.
  const double cycles = static_cast<double>(reading.sequence) - static_cast<double>(last.sequence);
  const double elapsed =
      (static_cast<double>(reading.simulated_time) - static_cast<double>(last.simulated_time)) * kNanosecond;
  if (!(elapsed > 0.0 && std::fabs(elapsed - cycles * period) <= 0.5 * period)) return false;
  const double change = settings.acceleration_limit * elapsed;
  for (int i = 0; i < reading.group_count; ++i) {
    const double speed = reading.shaft_speed[i], before = last.shaft_speed[i];
    const double turned = (reading.shaft_position[i] - last.shaft_position[i]) / elapsed;
    if (std::fabs(speed - before) > change + settings.tolerance) return false;
    if (std::fabs(turned - 0.5 * (speed + before)) > 0.25 * change + settings.tolerance) return false;
  }
  return true;
}

}  // namespace

Plausibility judge(const PlausibilitySettings& settings, double period, int group_count, PlausibilityState& state,
                   EncoderReading& reading) {
  if (!has_signal(reading, group_count)) {
    state = {};
    state.distrusted = true;
    return Plausibility::unusable;
  }
  const double longest = settings.timeout * (1.0 + kRounding);
  const bool in_range = is_in_range(settings, reading);
  if (in_range && (!state.known || can_follow(settings, period, state.last, reading))) {
    state.known = true;
    state.last = reading;
    state.refused = 0;
    if (state.distrusted && static_cast<double>(++state.plausible) * period <= longest) return Plausibility::unusable;
    state.distrusted = false;
    state.plausible = 0;
    return Plausibility::plausible;
  }
  state.plausible = 0;
  if (!state.distrusted && state.known && static_cast<double>(++state.refused) * period <= longest) {
    reading.shaft_speed = state.last.shaft_speed;
    return Plausibility::held;
  }
  // Judged anew from here on.
  state.distrusted = true;
  state.known = in_range;
  state.last = reading;
  return Plausibility::unusable;
}

}  // namespace slewlab::controller
