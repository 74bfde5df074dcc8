// A dry joint that gives before it slides: Jenkins elements (a spring in series with Coulomb friction) in parallel
// (Iwan),
//   s_i <- clamp(s_i + (x - x_before) / (r_i give), -1, 1),   s = sum w_i s_i,   torque = -level s,
// s being the part of the level that the joint holds. Raceways, rollers and brake plates give by micrometres, point after
// point, and a machine that rests on them rings where dry friction would hold it still. For give -> 0 it is dry friction.
//
// From rest s follows Dahl's curve 1 - exp(-x / give) as its closest polygon of four corners that starts at the
// curve's slope 1 / give: corners lie e above the curve, the middles of the sides e below, the last corner, where all
// elements slide, is s = 1. That is e = 1.7 % (1.8 % as rounded here), corners at x / give = r_i; the slopes m_i of its sides give
// w_i = r_i (m_i - m_{i+1}). Back and forth it keeps Masing's rule, s = s_turn - 2 s_rest((x_turn - x) / 2), closes
// every loop and does not drift, as Dahl's own model does.
//
// Sources: Jenkins 1962, "Analysis of the stress-strain relationships in reactor grade graphite", Br. J. Appl. Phys. 13;
// Iwan 1966, "A distributed-element model for hysteresis", J. Appl. Mech. 33; Dahl 1968, "A solid friction model".
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "common/effect.h"

namespace slewlab::sim {

inline constexpr int kPreslidingElements = 4;
inline constexpr std::array<double, kPreslidingElements> kPreslidingRatio{0.19, 0.87, 1.89, 4.07};  // r_i
// w_i; of 1024, so that sliding is s = 1 to the bit.
inline constexpr std::array<double, kPreslidingElements> kPreslidingShare{78.0 / 1024.0, 300.0 / 1024.0,
                                                                          391.0 / 1024.0, 255.0 / 1024.0};

struct Presliding {
  double give = 0.0;    // [rad] of the joint, level over its first stiffness; positive
  double before = 0.0;  // [rad]
  std::array<double, kPreslidingElements> held{};  // s_i
  bool begun = false;   // the joint is relaxed where it is first asked
};

// s after the joint has moved to `angle` [rad].
inline double presliding_share(Presliding& joint, double angle) {
  const double moved = joint.begun ? (angle - joint.before) / joint.give : 0.0;
  joint.begun = true;
  joint.before = angle;
  double share = 0.0;
  for (std::size_t i = 0; i < kPreslidingElements; ++i) {
    joint.held[i] = std::clamp(joint.held[i] + moved / kPreslidingRatio[i], -1.0, 1.0);
    share += kPreslidingShare[i] * joint.held[i];
  }
  return share;
}

// The parameter `give` of an effect; prior about `typical` and as wide.
inline common::EffectParameter give_parameter(std::string_view meaning, double upper, double typical) {
  return {.name = "give",
          .unit = common::Unit::radian,
          .meaning = meaning,
          .lower = 0.0,
          .upper = upper,
          .typical = typical,
          .prior_scale = typical,
          .scale = common::ParameterScale::linear,
          .absent = std::nullopt};
}

}  // namespace slewlab::sim
