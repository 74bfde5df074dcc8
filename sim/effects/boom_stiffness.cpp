#include "sim/effects/boom_stiffness.h"

namespace slewlab::sim {

namespace {

void change(EffectValues values, MachineParameters& parameters) {
  parameters.crane.boom.youngs_modulus *= values[0];
  parameters.crane.boom.shear_modulus *= values[0];
}

}  // namespace

const EffectDescription& boom_stiffness() {
  static const EffectDescription description{
      .about = {.name = "boom_stiffness",
                .subsystem = common::Subsystem::boom,
                .physics = "the boom is stiffer or softer than its chords say",
                .parameters = {{.name = "factor",
                                .unit = common::Unit::none,
                                .meaning = "stiffness over the nominal one",
                                .lower = 0.4,
                                .upper = 2.5,
                                .typical = 0.85,
                                .prior_scale = 0.1,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = 1.0}}},
      .ports = {EffectPort::parameters},
      .change = change};
  return description;
}

}  // namespace slewlab::sim
