// What goes up and down as something turns: a sine and its second harmonic,
//   sin(n theta + phase) + a sin(2 n theta) + b cos(2 n theta).
// What acts over a step is the mean along the turned angle, exact for a steady speed.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "common/effect.h"
#include "sim/effects/effect.h"
#include "sim/effects/mean_sine.h"

namespace slewlab::sim {

struct Ripple {
  double order = 0.0;         // n [-], per radian of the angle that it is asked at
  double phase = 0.0;         // [rad]
  double second_sine = 0.0, second_cosine = 0.0;  // a, b [-] of the first harmonic's amplitude
};

// The same wave, `by` [rad] of its first harmonic on.
inline Ripple shifted(Ripple ripple, double by) {
  const double sine = std::sin(2.0 * by), cosine = std::cos(2.0 * by);
  ripple.phase += by;
  const double second_sine = ripple.second_sine * cosine - ripple.second_cosine * sine;
  ripple.second_cosine = ripple.second_sine * sine + ripple.second_cosine * cosine;
  ripple.second_sine = second_sine;
  return ripple;
}

// One wave for all groups, each half of them with a phase of its own: no two rotors and no two pinions are mounted alike.
inline std::array<Ripple, kMaximumGroupCount> ripples_of_groups(const Ripple& first, double phase_last, int group_count) {
  std::array<Ripple, kMaximumGroupCount> ripples{};
  for (int i = 0; i < group_count; ++i) {
    ripples[static_cast<std::size_t>(i)] = group_side(i, group_count) < 0.0 ? shifted(first, phase_last - first.phase) : first;
  }
  return ripples;
}

// Mean over a step that turns by `turned` [rad] around `angle` [rad].
inline double mean_ripple(const Ripple& ripple, double angle, double turned) {
  return mean_sine(ripple.order * angle + ripple.phase, ripple.order * turned) +
         ripple.second_sine * mean_sine(2.0 * ripple.order * angle, 2.0 * ripple.order * turned) +
         ripple.second_cosine *
             mean_sine(2.0 * ripple.order * angle + 0.5 * std::numbers::pi, 2.0 * ripple.order * turned);
}

// In both of them at once, so that a fit finds it from nothing whatever its phase.
inline common::EffectParameter second_sine_parameter() {
  return {.name = "second_sine",
          .unit = common::Unit::none,
          .meaning = "sine of twice the angle, share of the amplitude",
          .lower = -1.0,
          .upper = 1.0,
          .typical = 0.0,
          .prior_scale = 0.3,
          .scale = common::ParameterScale::linear,
          .absent = 0.0,
          .detail = true};
}

inline common::EffectParameter second_cosine_parameter() {
  common::EffectParameter parameter = second_sine_parameter();
  parameter.name = "second_cosine";
  parameter.meaning = "cosine of twice the angle, share of the amplitude";
  return parameter;
}

}  // namespace slewlab::sim
