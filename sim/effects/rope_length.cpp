// Rope length: the rope is factor times as long as nominal, so that the swing's frequency goes with its inverse
// square root (2.17).
// Source: thesis (2.17).
#include "sim/effects/effect.h"

namespace slewlab::sim {

namespace {

void change_rope_length(const common::EffectValues& values, MachineParameters& parameters) {
  parameters.crane.load.rope_length *= values["factor"];
}

}  // namespace

const EffectDescription& rope_length() {
  static const EffectDescription description{
      .about = {.name = "rope_length",
                .subsystem = common::Subsystem::load,
                .physics = "the rope is longer or shorter than nominal",
                .parameters = {{.name = "factor",
                                .unit = common::Unit::none,
                                .meaning = "length over the nominal one",
                                .lower = 0.3,
                                .upper = 3.0,
                                .typical = 1.15,
                                .prior_scale = 0.1,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = 1.0}},
                .needs = {.load = true},
                .stands_for = {"rope length"}},
      .ports = {EffectPort::parameters},
      .change = change_rope_length};
  return description;
}

}  // namespace slewlab::sim
