// Larger play: every gear has more play than the crane's file says,
//   Delta_b = Delta_b,nominal + added / 2,   added: whole play on the slew axis.
// Source: thesis 2.6.1 (wear; 2-4 % of the module is what a new pinion has).
#include "sim/effects/effect.h"

namespace slewlab::sim {

namespace {

void change_larger_play(const common::EffectValues& values, MachineParameters& parameters) {
  for (GearContact& gear : parameters.gear) gear.half_play += 0.5 * values["added_play"];
}

}  // namespace

const EffectDescription& larger_play() {
  static const EffectDescription description{
      .about = {.name = "larger_play",
                .subsystem = common::Subsystem::drive,
                .physics = "all gears have more play than specified",
                .parameters = {{.name = "added_play",
                                .unit = common::Unit::radian,
                                .per = common::ScaleOf::gear_windup,
                                .meaning = "additional whole play on the slew axis",
                                .lower = 0.0,
                                .upper = 8.137,
                                .typical = 0.8136,
                                .prior_scale = 0.3255,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0}},
                .needs = {.gears = true},
                .family = common::Family::play},
      .ports = {EffectPort::parameters},
      .change = change_larger_play};
  return description;
}

}  // namespace slewlab::sim
