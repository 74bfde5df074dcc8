// Friction of the slew bearing that is not the same in both directions: (1 + a) times as large against positive motion,
// (1 - a) times against negative.
#pragma once

#include <optional>

#include "common/effect.h"

namespace slewlab::sim {

inline common::EffectParameter asymmetry_parameter() {
  return {.name = "asymmetry",
          .unit = common::Unit::none,
          .meaning = "relative excess against positive motion, lack against negative",
          .lower = -1.0,
          .upper = 1.0,
          .typical = 0.0,
          .prior_scale = 0.2,
          .scale = common::ParameterScale::linear,
          .absent = std::nullopt};
}

}  // namespace slewlab::sim
