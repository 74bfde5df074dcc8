// Boom damping: the damping ratio at the boom's first two bending modes is factor times the nominal one,
// (3.15).
//   zeta_i' = factor zeta_i, i = 1, 2
// Source: thesis 3.3.2 (structural damping; its ratio is not given).
#include "sim/effects/effect.h"

namespace slewlab::sim {

namespace {

void change_boom_damping(const common::EffectValues& values, MachineParameters& parameters) {
  parameters.crane.boom.damping_ratio *= values["factor"];
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
                                .absent = 1.0}},
                .needs = {.flexible_boom = true},
                .stands_for = {"boom damping"}},
      .ports = {EffectPort::parameters},
      .change = change_boom_damping};
  return description;
}

}  // namespace slewlab::sim
