#include "sim/effects/house_inertia.h"

namespace slewlab::sim {

namespace {

void change(EffectValues values, MachineParameters& parameters) {
  parameters.crane.house.inertia *= values[0];
}

}  // namespace

const EffectDescription& house_inertia() {
  static const EffectDescription description{
      .about = {.name = "house_inertia",
                .subsystem = common::Subsystem::house,
                .physics = "the crane house has another inertia",
                .parameters = {{.name = "factor",
                                .unit = common::Unit::none,
                                .meaning = "inertia over the nominal one",
                                .lower = 0.1,
                                .upper = 30.0,
                                .typical = 3.0,
                                .prior_scale = 0.5,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = 1.0}}},
      .ports = {EffectPort::parameters},
      .change = change};
  return description;
}

}  // namespace slewlab::sim
