// Uneven gearbox stiffness of the motor groups (uneven_groups.h).
#include "sim/effects/uneven_groups.h"

namespace slewlab::sim {

namespace {

void change_uneven_gearbox_stiffness(const common::EffectValues& values, MachineParameters& parameters) {
  const int count = parameters.crane.drive.group_count;
  for (int i = 0; i < count; ++i) parameters.gear[i].stiffness *= uneven_factor(values, i, count);
}

}  // namespace

const EffectDescription& uneven_gearbox_stiffness() {
  static const EffectDescription description{
      .about = {.name = "uneven_gearbox_stiffness",
                .subsystem = common::Subsystem::drive,
                .physics = "the motor groups differ in their gearbox stiffness",
                .parameters = {uneven_share_parameter(), uneven_mean_parameter()},
                .needs = {.gears = true, .groups = 2},
                .family = common::Family::elasticity},
      .ports = {EffectPort::parameters},
      .change = change_uneven_gearbox_stiffness};
  return description;
}

}  // namespace slewlab::sim
