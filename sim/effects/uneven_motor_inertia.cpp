// Uneven motor inertia: the first half of the motor groups has more, the last half less,
//   J_i = J (1 + m) (1 + s), J (1 + m) (1 - s).
// The middle one of an odd number of groups keeps its own. One group has no difference.
// Source: thesis 2.4, first cause of an uneven load distribution (small deviations between drives).
#include "sim/effects/effect.h"

namespace slewlab::sim {

namespace {

void change_uneven_motor_inertia(const common::EffectValues& values, MachineParameters& parameters) {
  const int count = parameters.crane.drive.group_count;
  for (int i = 0; i < count; ++i) parameters.group_inertia[i] *= (1.0 + values["mean"]) * (1.0 + values["share"] * group_side(i, count));
}

}  // namespace

const EffectDescription& uneven_motor_inertia() {
  static const EffectDescription description{
      .about = {.name = "uneven_motor_inertia",
                .subsystem = common::Subsystem::drive,
                .physics = "the motor groups differ in their motor inertia",
                .parameters = {{.name = "share",
                                .unit = common::Unit::none,
                                .meaning = "relative excess of the first half of the groups",
                                .lower = -0.6,
                                .upper = 0.6,
                                .typical = 0.2,
                                .prior_scale = 0.1,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0},
                               {.name = "mean",
                                .unit = common::Unit::none,
                                .meaning = "relative excess of all groups: a defect sits in one of them",
                                .lower = -0.4,
                                .upper = 0.4,
                                .typical = 0.0,
                                .prior_scale = 0.1,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0,
                                .detail = true}},
                .needs = {.groups = 2},
                .family = common::Family::mass},
      .ports = {EffectPort::parameters},
      .change = change_uneven_motor_inertia};
  return description;
}

}  // namespace slewlab::sim
