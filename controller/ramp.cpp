#include "controller/ramp.h"

#include <algorithm>
#include <cmath>

namespace slewlab::controller {
namespace {

// T of a change from rest to rest: towards zero by the deceleration time, away by the acceleration time.
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

void arrive(RampState& state) {
  state.speed = state.target;
  state.acceleration = 0.0;
  state.moving = false;
}

void begin(RampState& state, double target) {
  state.target = target;
  state.moving = true;
  state.elapsed = 0.0;
  state.start_speed = state.speed;
  state.start_acceleration = state.acceleration;
}

// The speed at which the acceleration would end if it were taken away at once.
double speed_when_let_go(const RampState& state, double jerk) {
  return state.speed + 0.5 * state.acceleration * std::abs(state.acceleration) / jerk;
}

double choose_jerk(const RampState& state, double target, double jerk_from_rest) {
  if (state.acceleration == 0.0 || state.jerk == 0.0) return jerk_from_rest;
  const double gentler = std::min(state.jerk, jerk_from_rest);
  const bool leads_there = (target - speed_when_let_go(state, gentler)) * state.acceleration >= 0.0;
  return leads_there ? gentler : state.jerk;
}

void begin_s_curve(const RampSettings& settings, RampState& state, double target) {
  const double change = target - state.speed;
  if (change == 0.0 && state.acceleration == 0.0) {
    state.target = target;
    arrive(state);
    return;
  }
  const double share = settings.curved_share;
  double full_acceleration = std::abs(state.acceleration);
  double jerk = state.jerk;
  if (change != 0.0) {
    const double time = change_time(settings, state.speed, target);
    full_acceleration = std::abs(change) / (time * (1.0 - share));
    jerk = choose_jerk(state, target, full_acceleration / (share * time));
  }

  const double a0 = state.acceleration;
  const double direction = target >= speed_when_let_go(state, jerk) ? 1.0 : -1.0;
  const double peak_squared = direction * jerk * change + 0.5 * a0 * a0;
  const double peak = direction * std::min(full_acceleration, std::sqrt(std::max(0.0, peak_squared)));

  begin(state, target);
  state.jerk = jerk;
  state.peak_acceleration = peak;
  state.rise_time = std::abs(peak - a0) / jerk;
  state.fall_time = std::abs(peak) / jerk;
  const double held_change = change - 0.5 * (a0 + peak) * state.rise_time - 0.5 * peak * state.fall_time;
  state.hold_time = peak == 0.0 ? 0.0 : std::max(0.0, held_change / peak);
}

void begin_linear(RampState& state, double target, double duration) {
  state.jerk = 0.0;
  if (duration <= 0.0) {
    state.target = target;
    arrive(state);
    return;
  }
  state.acceleration = (target - state.speed) / duration;
  begin(state, target);
  state.peak_acceleration = state.acceleration;
  state.rise_time = 0.0;
  state.hold_time = duration;
  state.fall_time = 0.0;
}

void advance(RampState& state, double period) {
  if (!state.moving) return;
  state.elapsed += period;
  const double t = state.elapsed;
  const double held_until = state.rise_time + state.hold_time;
  const double left = held_until + state.fall_time - t;
  const double a0 = state.start_acceleration;
  const double peak = state.peak_acceleration;
  if (left <= 0.0) {
    arrive(state);
  } else if (t < state.rise_time) {
    const double part = t / state.rise_time;
    state.acceleration = a0 + (peak - a0) * part;
    state.speed = state.start_speed + t * (a0 + 0.5 * (peak - a0) * part);
  } else if (t < held_until) {
    state.acceleration = peak;
    state.speed = state.start_speed + 0.5 * (a0 + peak) * state.rise_time + peak * (t - state.rise_time);
  } else {
    state.acceleration = peak * left / state.fall_time;
    state.speed = state.target - 0.5 * state.acceleration * left;
  }
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
