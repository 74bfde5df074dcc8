#include "sim/effects/uneven_play.h"

#include <algorithm>

namespace slewlab::sim {

namespace {

void change(EffectValues values, MachineParameters& parameters) {
  const int count = parameters.crane.drive.group_count;
  for (int i = 0; i < count; ++i) {
    double& half_play = parameters.gear[i].half_play;
    half_play = std::max(0.0, half_play + 0.25 * values[0] * group_side(i, count));
  }
}

}  // namespace

const EffectDescription& uneven_play() {
  static const EffectDescription description{
      .about =
          {.name = "uneven_play",
           .subsystem = common::Subsystem::drive,
           .physics = "the motor groups differ in their play",
           .parameters = {{.name = "difference",
                           .unit = common::Unit::radian,
                           .meaning =
                               "whole play of the first half of the groups less that of the last, slew axis",
                           .lower = -2e-3,
                           .upper = 2e-3,
                           .typical = 5e-4,
                           .prior_scale = 2e-4,
                           .scale = common::ParameterScale::linear,
                           .absent = 0.0}}},
      .ports = {EffectPort::parameters},
      .change = change};
  return description;
}

}  // namespace slewlab::sim
