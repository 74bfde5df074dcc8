// Hydraulic compliance: the oil column of a hydraulic drive is a damped spring in series with the gearbox,
//   1/k = 1/k_gearbox + 1/k_oil,
//   c = c_gearbox (k_oil / (k_gearbox + k_oil))^2 + c_oil (k_gearbox / (k_gearbox + k_oil))^2,
// two damped springs in series far below their own frequencies. Per group, on the slew axis.
// Source: thesis 1.1 (the Sleipnir's drive: "an additional stiffness as a result of the oil").
#include "sim/effects/effect.h"

#include <limits>

namespace slewlab::sim {

namespace {

void change_hydraulic_compliance(const common::EffectValues& values, MachineParameters& parameters) {
  for (GearContact& gear : parameters.gear) {
    const double share = values["oil_stiffness"] / (gear.stiffness + values["oil_stiffness"]);
    gear.stiffness *= share;
    gear.damping = gear.damping * share * share + values["oil_damping"] * (1.0 - share) * (1.0 - share);
  }
}

}  // namespace

const EffectDescription& hydraulic_compliance() {
  static const EffectDescription description{
      .about = {.name = "hydraulic_compliance",
                .subsystem = common::Subsystem::drive,
                .physics = "the oil of a hydraulic drive is a damped spring in series with the gearbox",
                .parameters = {{.name = "oil_stiffness",
                                .unit = common::Unit::newton_metre_per_radian,
                                .per = common::ScaleOf::gear_stiffness,
                                .meaning = "of one motor group's oil, on the slew axis",
                                .lower = 0.07487,
                                .upper = 149.8,
                                .typical = 0.7488,
                                .prior_scale = 1.0,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = std::numeric_limits<double>::infinity()},
                               {.name = "oil_damping",
                                .unit = common::Unit::newton_metre_second_per_radian,
                                .per = common::ScaleOf::axis_damping,
                                .meaning = "of one motor group's oil (leakage), on the slew axis",
                                .lower = 0.0,
                                .upper = 2.438,
                                .typical = 0.6093,
                                .prior_scale = 0.6093,
                                .scale = common::ParameterScale::linear,
                                .absent = std::nullopt}},
                .needs = {.gears = true},
                .family = common::Family::elasticity},
      .ports = {EffectPort::parameters},
      .change = change_hydraulic_compliance};
  return description;
}

}  // namespace slewlab::sim
