#include "sim/effects/flyjib_torsion.h"

namespace slewlab::sim {

namespace {

void change(EffectValues values, MachineParameters& parameters) {
  parameters.crane.boom.jib_mass += values[0];
  parameters.crane.boom.jib_eccentricity += values[1];
}

}  // namespace

const EffectDescription& flyjib_torsion() {
  static const EffectDescription description{
      .about = {.name = "flyjib_torsion",
                .subsystem = common::Subsystem::boom,
                .physics = "a fly jib in front of the boom's axis twists the boom",
                .parameters = {{.name = "mass",
                                .unit = common::Unit::kilogram,
                                .meaning = "of the jib",
                                .lower = 0.0,
                                .upper = 3e4,
                                .typical = 3e3,
                                .prior_scale = 2e3,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0},
                               {.name = "eccentricity",
                                .unit = common::Unit::metre,
                                .meaning = "of the jib's centre and sheave from the boom's axis",
                                .lower = 0.0,
                                .upper = 10.0,
                                .typical = 5.0,
                                .prior_scale = 2.0,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0,
                                .tries = {2.5}}}},
      .ports = {EffectPort::parameters},
      .change = change};
  return description;
}

}  // namespace slewlab::sim
