// What goes up and down as something turns: a sine and its second harmonic,
//   sin(n theta + phase) + a sin(2 n theta) + b cos(2 n theta).
// What acts over a step is the mean along the turned angle, exact for a steady speed. With m = n theta in its middle and h half of what n theta turns by:
//   (sin(m) cos(phase) + cos(m) sin(phase)) sin(h) / h + (2 a sin(m) cos(m) + b (1 - 2 sin(m)^2)) cos(h) sin(h) / h.
#pragma once

#include <array>
#include <cmath>

#include "common/effect.h"
#include "sim/effects/effect.h"
#include "sim/effects/half_turn.h"
#include "sim/effects/uneven_groups.h"

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

// The same as it is asked at every step: with the phase's sine and cosine.
struct RippleWave {
  double order = 0.0;                             // [-]
  double first_sine = 1.0, first_cosine = 0.0;    // [-] of sin(m), cos(m)
  double second_sine = 0.0, second_cosine = 0.0;  // [-]
};
inline RippleWave wave_of(const Ripple& ripple) {
  return {ripple.order, std::cos(ripple.phase), std::sin(ripple.phase), ripple.second_sine, ripple.second_cosine};
}

// The same, `factor` [-] times as high.
inline RippleWave scaled(RippleWave wave, double factor) {
  wave.first_sine *= factor;
  wave.first_cosine *= factor;
  wave.second_sine *= factor;
  wave.second_cosine *= factor;
  return wave;
}

// What is of each half of the groups alone: no two rotors and no two pinions are mounted alike, and a defect sits in one of them.
struct RippleSides {
  double phase_last = 0.0;  // [rad] of the last half; the middle one of an odd number goes with the first
  double share = 0.0;       // [-] by how much the first half's ripple is larger than the mean, and the last half's smaller
};

// One shape of wave for all groups.
using GroupRipples = std::array<RippleWave, kMaximumGroupCount>;
inline GroupRipples ripples_of_groups(const Ripple& first, const RippleSides& sides, int group_count) {
  GroupRipples ripples{};
  for (int i = 0; i < group_count; ++i) {
    const Ripple ripple = group_side(i, group_count) < 0.0 ? shifted(first, sides.phase_last - first.phase) : first;
    ripples[static_cast<std::size_t>(i)] = scaled(wave_of(ripple), uneven_factor(sides.share, 0.0, i, group_count));
  }
  return ripples;
}

// Mean over a step that turns by `turned` [rad] around `angle` [rad].
inline double mean_ripple(const RippleWave& wave, double angle, double turned) {
  const double middle = wave.order * angle, sine = std::sin(middle), cosine = std::cos(middle);
  const HalfTurn half = half_turn(wave.order * turned);
  const double first = wave.first_sine * sine + wave.first_cosine * cosine;
  const double second = 2.0 * wave.second_sine * sine * cosine + wave.second_cosine * (1.0 - 2.0 * sine * sine);
  return (first + second * half.cosine) * half.share;
}

// Beyond 1 the other half's wave is turned over: a ripple in one half alone lies within the bounds.
inline common::EffectParameter ripple_share_parameter() {
  common::EffectParameter parameter = uneven_share_parameter();
  parameter.meaning = "relative excess of the first half of the groups: 1 where they alone have it";
  parameter.lower = -2.0;
  parameter.upper = 2.0;
  parameter.typical = 0.0;
  parameter.prior_scale = 0.3;
  parameter.detail = true;
  return parameter;
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
