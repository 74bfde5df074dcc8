// Load mass: the load is factor times as heavy as nominal, M_l = factor M_l,nominal.
// Source: thesis 3.3.3; the load's mass is what the operator was told.
#include "sim/effects/effect.h"

namespace slewlab::sim {

namespace {

void change_load_mass(const common::EffectValues& values, MachineParameters& parameters) { parameters.crane.load.mass *= values["factor"]; }

}  // namespace

const EffectDescription& load_mass() {
  static const EffectDescription description{
      .about = {.name = "load_mass",
                .subsystem = common::Subsystem::load,
                .physics = "the load is heavier or lighter than nominal",
                .parameters = {{.name = "factor",
                                .unit = common::Unit::none,
                                .meaning = "mass over the nominal one",
                                .lower = 0.2,
                                .upper = 5.0,
                                .typical = 1.2,
                                .prior_scale = 0.15,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = 1.0}},
                .needs = {.load = true},
                .family = common::Family::mass,
                .stands_for = {"load mass"}},
      .ports = {EffectPort::parameters},
      .change = change_load_mass};
  return description;
}

}  // namespace slewlab::sim
