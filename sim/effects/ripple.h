// What goes up and down as something turns: a sine and its second harmonic,
//   sin(n theta + phase) + s sin(2 n theta + second_phase).
// What acts over a step is the mean along the turned angle, exact for a steady speed.
#pragma once

#include <numbers>
#include <optional>

#include "common/effect.h"
#include "sim/effects/mean_sine.h"

namespace slewlab::sim {

struct Ripple {
  double order = 0.0;         // n [-], per radian of the angle that it is asked at
  double phase = 0.0;         // [rad]
  double second_share = 0.0;  // s [-] of the first harmonic's amplitude
  double second_phase = 0.0;  // [rad]
};

// Mean over a step that turns by `turned` [rad] around `angle` [rad].
inline double mean_ripple(const Ripple& ripple, double angle, double turned) {
  return mean_sine(ripple.order * angle + ripple.phase, ripple.order * turned) +
         ripple.second_share *
             mean_sine(2.0 * ripple.order * angle + ripple.second_phase, 2.0 * ripple.order * turned);
}

inline common::EffectParameter second_share_parameter() {
  return {.name = "second_share",
          .unit = common::Unit::none,
          .meaning = "second harmonic, share of the amplitude",
          .lower = 0.0,
          .upper = 1.0,
          .typical = 0.0,
          .prior_scale = 0.3,
          .scale = common::ParameterScale::linear,
          .absent = 0.0};
}

inline common::EffectParameter second_phase_parameter() {
  return {.name = "second_phase",
          .unit = common::Unit::radian,
          .meaning = "phase of the second harmonic at the start",
          .lower = -std::numbers::pi,
          .upper = std::numbers::pi,
          .typical = 0.0,
          .prior_scale = 2.0,
          .scale = common::ParameterScale::linear,
          .absent = std::nullopt};
}

}  // namespace slewlab::sim
