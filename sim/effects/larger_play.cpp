#include "sim/effects/larger_play.h"

namespace slewlab::sim {

namespace {

void change(EffectValues values, MachineParameters& parameters) {
  for (GearContact& gear : parameters.gear) gear.half_play += 0.5 * values[0];
}

}  // namespace

const EffectDescription& larger_play() {
  static const EffectDescription description{
      .about = {.name = "larger_play",
                .subsystem = common::Subsystem::drive,
                .physics = "all gears have more play than specified",
                .parameters = {{.name = "added_play",
                                .unit = common::Unit::radian,
                                .meaning = "additional whole play on the slew axis",
                                .lower = 0.0,
                                .upper = 5e-3,
                                .typical = 5e-4,
                                .prior_scale = 2e-4,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0}}},
      .ports = {EffectPort::parameters},
      .change = change};
  return description;
}

}  // namespace slewlab::sim
