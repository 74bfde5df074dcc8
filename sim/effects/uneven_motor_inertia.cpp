// Uneven motor inertia of the motor groups (uneven_groups.h).
#include "sim/effects/uneven_groups.h"

namespace slewlab::sim {

namespace {

void change_uneven_motor_inertia(const common::EffectValues& values, MachineParameters& parameters) {
  const int count = parameters.crane.drive.group_count;
  for (int i = 0; i < count; ++i) parameters.group_inertia[i] *= uneven_factor(values, i, count);
}

}  // namespace

const EffectDescription& uneven_motor_inertia() {
  static const EffectDescription description{
      .about = {.name = "uneven_motor_inertia",
                .subsystem = common::Subsystem::drive,
                .physics = "the motor groups differ in their motor inertia",
                .parameters = {uneven_share_parameter(), uneven_mean_parameter()},
                .needs = {.groups = 2},
                .family = common::Family::mass},
      .ports = {EffectPort::parameters},
      .change = change_uneven_motor_inertia};
  return description;
}

}  // namespace slewlab::sim
