// A number of the motor groups that is not the same in all: of the first half larger, of the last half smaller,
//   x_i = x (1 + m) (1 + s), x (1 + m) (1 - s).
// The middle one of an odd number of groups keeps its mean. One group has no difference. A defect sits in one of them and takes the mean m with it.
// Source: thesis 2.4, first cause of an uneven load distribution (small deviations between drives).
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

// Of one group's number.
inline double uneven_factor(double share, double mean, int group, int group_count) { return (1.0 + mean) * (1.0 + share * group_side(group, group_count)); }
inline double uneven_factor(const common::EffectValues& values, int group, int group_count) {
  return uneven_factor(values["share"], values["mean"], group, group_count);
}

inline common::EffectParameter uneven_share_parameter() {
  return {.name = "share",
          .unit = common::Unit::none,
          .meaning = "relative excess of the first half of the groups",
          .lower = -0.6,
          .upper = 0.6,
          .typical = 0.2,
          .prior_scale = 0.1,
          .scale = common::ParameterScale::linear,
          .absent = 0.0};
}

inline common::EffectParameter uneven_mean_parameter() {
  return {.name = "mean",
          .unit = common::Unit::none,
          .meaning = "relative excess of all groups: a defect sits in one of them",
          .lower = -0.4,
          .upper = 0.4,
          .typical = 0.0,
          .prior_scale = 0.1,
          .scale = common::ParameterScale::linear,
          .absent = 0.0,
          .detail = true};
}

}  // namespace slewlab::sim
