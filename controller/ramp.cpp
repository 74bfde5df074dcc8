#include "controller/ramp.h"

#include <algorithm>
#include <cmath>

namespace slewlab::controller {
namespace {

// Time of the change at full-speed scale: towards zero by the deceleration time, away by the acceleration
// time.
double change_time(const RampSettings& settings, double from, double to) {
  double towards_zero = 0.0;
  double away_from_zero = 0.0;
  if (from * to < 0.0) {
    towards_zero = std::abs(from);
    away_from_zero = std::abs(to);
  } else if (std::abs(to) < std::abs(from)) {
    towards_zero = std::abs(from) - std::abs(to);
  } else {
    away_from_zero = std::abs(to) - std::abs(from);
  }
  return (towards_zero * settings.deceleration_time + away_from_zero * settings.acceleration_time) /
         settings.top_speed;
}

void begin(RampState& state, double target, double duration, double curved_time, double start_acceleration) {
  state.target = target;
  state.elapsed = 0.0;
  state.duration = duration;
  state.curved_time = curved_time;
  state.start_speed = state.speed;
  state.start_acceleration = start_acceleration;
  if (duration > 0.0) {
    state.peak_acceleration =
        (target - state.speed - 0.5 * start_acceleration * curved_time) / (duration - curved_time);
  } else {
    state.peak_acceleration = 0.0;
    state.speed = target;
    state.acceleration = 0.0;
  }
}

void begin_s_curve(const RampSettings& settings, RampState& state, double target) {
  const double share = settings.curved_share;
  double duration = change_time(settings, state.speed, target);
  if (state.acceleration != 0.0) {
    const double full_time = std::max(settings.acceleration_time, settings.deceleration_time);
    const double full_acceleration = settings.top_speed / (full_time * (1.0 - share));
    duration = std::max(duration, 2.0 * share * full_time * std::abs(state.acceleration) / full_acceleration);
  }
  begin(state, target, duration, share * duration, state.acceleration);
}

void begin_linear(RampState& state, double target, double duration) {
  begin(state, target, duration, 0.0, 0.0);
  state.acceleration = state.peak_acceleration;
}

// The profile's speed and acceleration at `elapsed`.
void evaluate(RampState& state) {
  const double t = state.elapsed;
  if (t >= state.duration) {
    state.speed = state.target;
    state.acceleration = 0.0;
    state.duration = 0.0;
    return;
  }
  const double curved = state.curved_time;
  const double a0 = state.start_acceleration;
  const double ap = state.peak_acceleration;
  if (t < curved) {
    const double share = t / curved;
    state.acceleration = a0 + (ap - a0) * share;
    state.speed = state.start_speed + t * (a0 + 0.5 * (ap - a0) * share);
  } else if (t <= state.duration - curved) {
    state.acceleration = ap;
    state.speed = state.start_speed + 0.5 * (a0 + ap) * curved + ap * (t - curved);
  } else {
    const double left = state.duration - t;
    state.acceleration = ap * left / curved;
    state.speed = state.target - 0.5 * state.acceleration * left;
  }
}

void advance(RampState& state, double period) {
  if (state.duration <= 0.0) return;
  state.elapsed += period;
  evaluate(state);
}

}  // namespace

void step_ramp(const RampSettings& settings, RampState& state, double period, double target) {
  advance(state, period);
  const double allowed = std::clamp(target, -settings.top_speed, settings.top_speed);
  if (allowed == state.target && !state.stopping) return;
  state.stopping = false;
  if (settings.shape == RampShape::s_curve && settings.curved_share > 0.0) {
    begin_s_curve(settings, state, allowed);
  } else {
    begin_linear(state, allowed, change_time(settings, state.speed, allowed));
  }
}

void step_emergency_stop(const RampSettings& settings, RampState& state, double period) {
  advance(state, period);
  if (state.stopping) return;
  state.stopping = true;
  begin_linear(state, 0.0, settings.emergency_stop_time * std::abs(state.speed) / settings.top_speed);
}

}  // namespace slewlab::controller
