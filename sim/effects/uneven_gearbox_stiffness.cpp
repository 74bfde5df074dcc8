#include "sim/effects/uneven_gearbox_stiffness.h"

namespace slewlab::sim {

namespace {

void change(EffectValues values, MachineParameters& parameters) {
  const int count = parameters.crane.drive.group_count;
  for (int i = 0; i < count; ++i) parameters.gear[i].stiffness *= 1.0 + values[0] * group_side(i, count);
}

}  // namespace

const EffectDescription& uneven_gearbox_stiffness() {
  static const EffectDescription description{
      .about = {.name = "uneven_gearbox_stiffness",
                .subsystem = common::Subsystem::drive,
                .physics = "the motor groups differ in their gearbox stiffness",
                .parameters = {{.name = "share",
                                .unit = common::Unit::none,
                                .meaning = "relative excess of the first half of the groups",
                                .lower = -0.6,
                                .upper = 0.6,
                                .typical = 0.2,
                                .prior_scale = 0.1,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0}}},
      .ports = {EffectPort::parameters},
      .change = change};
  return description;
}

}  // namespace slewlab::sim
