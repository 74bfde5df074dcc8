#include "sim/effects/boom_damping.h"

namespace slewlab::sim {

namespace {

void change(EffectValues values, MachineParameters& parameters) {
  parameters.crane.boom.damping_ratio *= values[0];
}

}  // namespace

const EffectDescription& boom_damping() {
  static const EffectDescription description{
      .about = {.name = "boom_damping",
                .subsystem = common::Subsystem::boom,
                .physics = "the boom's structural damping differs",
                .parameters = {{.name = "factor",
                                .unit = common::Unit::none,
                                .meaning = "damping ratio over the nominal one",
                                .lower = 0.1,
                                .upper = 10.0,
                                .typical = 3.0,
                                .prior_scale = 0.5,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = 1.0}}},
      .ports = {EffectPort::parameters},
      .change = change};
  return description;
}

}  // namespace slewlab::sim
