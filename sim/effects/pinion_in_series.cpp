// Pinion in series: the teeth of pinion and ring are a spring behind the gearbox,
//   1/k = 1/k_gearbox + 1/k_pinion,   c = c_gearbox s (s + d (1 - s)),   s = k_pinion / (k_gearbox + k_pinion).
// Two damped springs in series, far below their own frequencies. d, `damping_share`, is the loss factor of the teeth over
// the gearbox's, c_pinion / k_pinion = d c_gearbox / k_gearbox: 0 is a bare spring, 1 keeps the gearbox's loss factor.
// What teeth damp is not known.
// Source: thesis (2.7), 713 MNm/rad per pinion for Table 2.2; section 2.6.2 takes it as rigid.
#include "sim/effects/effect.h"

#include <limits>

namespace slewlab::sim {

namespace {

void change_pinion_in_series(const common::EffectValues& values, MachineParameters& parameters) {
  const DriveParameters& drive = parameters.crane.drive;
  const double pinion = values["pinion_stiffness"] * drive.motors_per_group * drive.pinion_ratio * drive.pinion_ratio;
  for (GearContact& gear : parameters.gear) {
    const double share = pinion / (gear.stiffness + pinion);
    gear.stiffness *= share;
    gear.damping *= share * (share + values["damping_share"] * (1.0 - share));
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
                                .per = common::ScaleOf::gearbox_stiffness,
                                .meaning = "mesh stiffness of one pinion on its own shaft, (2.7)",
                                .lower = 0.7246,
                                .upper = 103.4,
                                .typical = 7.246,
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
                                .detail = true}},
                .needs = {.gears = true},
                .family = common::Family::elasticity},
      .ports = {EffectPort::parameters},
      .change = change_pinion_in_series};
  return description;
}

}  // namespace slewlab::sim
