#include "sim/effects/pinion_in_series.h"

#include <limits>

namespace slewlab::sim {

namespace {

void change(EffectValues values, MachineParameters& parameters) {
  const DriveParameters& drive = parameters.crane.drive;
  const double pinion = values[0] * drive.motors_per_group * drive.pinion_ratio * drive.pinion_ratio;
  for (GearContact& gear : parameters.gear) {
    const double share = pinion / (gear.stiffness + pinion);
    gear.stiffness *= share;
    gear.damping *= share * (share + values[1] * (1.0 - share));
  }
}

}  // namespace

const EffectDescription& pinion_in_series() {
  static const EffectDescription description{
      .about = {.name = "pinion_in_series",
                .subsystem = common::Subsystem::drive,
                .physics = "the pinion's teeth are a spring in series with the gearbox",
                .parameters = {{.name = "pinion_stiffness",
                                .unit = common::Unit::newton_metre_per_radian,
                                .meaning = "mesh stiffness of one pinion on its own shaft, (2.7)",
                                .lower = 5e6,
                                .upper = 7.13e8,
                                .typical = 5e7,
                                .prior_scale = 1.0,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = std::numeric_limits<double>::infinity()},
                               {.name = "damping_share",
                                .unit = common::Unit::none,
                                .meaning = "loss factor of the teeth over the gearbox's; 0: a bare spring",
                                .lower = 0.0,
                                .upper = 2.0,
                                .typical = 0.0,
                                .prior_scale = 0.5,
                                .scale = common::ParameterScale::linear,
                                .absent = std::nullopt,
                                .detail = true}}},
      .ports = {EffectPort::parameters},
      .change = change};
  return description;
}

}  // namespace slewlab::sim
