#include "sim/effects/load_mass.h"

namespace slewlab::sim {

namespace {

void change(EffectValues values, MachineParameters& parameters) { parameters.crane.load.mass *= values[0]; }

}  // namespace

const EffectDescription& load_mass() {
  static const EffectDescription description{
      .about = {.name = "load_mass",
                .subsystem = common::Subsystem::load,
                .physics = "the load is heavier or lighter than told",
                .parameters = {{.name = "factor",
                                .unit = common::Unit::none,
                                .meaning = "mass over the nominal one",
                                .lower = 0.2,
                                .upper = 5.0,
                                .typical = 1.2,
                                .prior_scale = 0.15,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = 1.0}}},
      .ports = {EffectPort::parameters},
      .change = change};
  return description;
}

}  // namespace slewlab::sim
