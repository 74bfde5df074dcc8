#include "sim/effects/hydraulic_compliance.h"

#include <limits>

namespace slewlab::sim {

namespace {

void change(EffectValues values, MachineParameters& parameters) {
  for (GearContact& gear : parameters.gear) {
    const double share = values[0] / (gear.stiffness + values[0]);
    gear.stiffness *= share;
    gear.damping = gear.damping * share * share + values[1] * (1.0 - share) * (1.0 - share);
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
                                .meaning = "of one motor group's oil, on the slew axis",
                                .lower = 5e8,
                                .upper = 1e12,
                                .typical = 5e9,
                                .prior_scale = 1.0,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = std::numeric_limits<double>::infinity()},
                               {.name = "oil_damping",
                                .unit = common::Unit::newton_metre_second_per_radian,
                                .meaning = "of one motor group's oil (leakage), on the slew axis",
                                .lower = 0.0,
                                .upper = 2e8,
                                .typical = 5e7,
                                .prior_scale = 5e7,
                                .scale = common::ParameterScale::linear,
                                .absent = std::nullopt}}},
      .ports = {EffectPort::parameters},
      .change = change};
  return description;
}

}  // namespace slewlab::sim
