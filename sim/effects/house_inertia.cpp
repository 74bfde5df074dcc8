// House inertia: the crane house is heavier than its closed form says, J_h = factor J_h,nominal.
// Machinery, cabin and counterweight stand outside the thin tube of (2.8).
// Source: thesis (2.8), Table 2.3; called negligible in 2.10.
#include "sim/effects/effect.h"

namespace slewlab::sim {

namespace {

void change_house_inertia(const common::EffectValues& values, MachineParameters& parameters) {
  parameters.crane.house.inertia *= values["factor"];
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
                                .absent = 1.0}},
                .family = common::Family::mass,
                .stands_for = {"house inertia"}},
      .ports = {EffectPort::parameters},
      .change = change_house_inertia};
  return description;
}

}  // namespace slewlab::sim
