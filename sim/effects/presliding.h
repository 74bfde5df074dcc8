// A dry joint that gives before it slides, by Dahl's law: over a motion dx the share s of its level that it holds goes as
//   ds/dx = (1 - s sign(dx)) / give,   s <- sign(dx) - (sign(dx) - s) exp(-|dx| / give)   exactly,   torque = -level s.
// Raceways, rollers and brake plates give by micrometres, point after point, and a machine that rests on them rings where
// dry friction would hold it still. From rest s = 1 - exp(-x / give), turned back from sliding s = -1 + 2 exp(-x / give):
// twice as stiff as from rest. |s| <= 1; for give -> 0 it is dry friction.
//
// Limits: the joint does not remember where it turned. A small cycle about a load does not close: every swing back and
// forth by d takes the loop nearer to the one about s = 0, by the factor exp(-2 d / give), so that a joint that holds a
// load creeps under vibration.
//
// Source: Dahl 1968, "A solid friction model", Aerospace Corporation TOR-0158(3107-18)-1.
#pragma once

#include <cmath>
#include <optional>
#include <string_view>

#include "common/effect.h"

namespace slewlab::sim {

struct Presliding {
  double give = 0.0;    // [rad] of the joint, level over its stiffness from rest; positive
  double before = 0.0;  // [rad]
  double held = 0.0;    // s
  bool begun = false;   // the joint is relaxed where it is first asked
};

// s after the joint has moved to `angle` [rad], without a turn on the way.
inline double presliding_share(Presliding& joint, double angle) {
  const double moved = joint.begun ? (angle - joint.before) / joint.give : 0.0;
  joint.begun = true;
  joint.before = angle;
  const double sliding = moved < 0.0 ? -1.0 : 1.0;
  joint.held = sliding - (sliding - joint.held) * std::exp(-std::fabs(moved));
  return joint.held;
}

// The parameter `give` of an effect; prior about `typical` and as wide.
inline common::EffectParameter give_parameter(std::string_view meaning, common::ScaleOf per, double upper, double typical) {
  return {.name = "give",
          .unit = common::Unit::radian,
          .per = per,
          .meaning = meaning,
          .lower = 0.0,
          .upper = upper,
          .typical = typical,
          .prior_scale = typical,
          .scale = common::ParameterScale::linear,
          .absent = std::nullopt};
}

}  // namespace slewlab::sim
