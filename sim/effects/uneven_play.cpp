// Uneven play: the first half of the motor groups has more play, the last half less, by the difference d
// of whole plays on the slew axis,
//   Delta_b,i = max(0, Delta_b + d / 4), max(0, Delta_b - d / 4).   One group has no difference.
// Source: thesis 2.4 and 2.6.1 (spread between drives; pinions are set one by one).
#include "sim/effects/effect.h"

#include <algorithm>

namespace slewlab::sim {

namespace {

void change_uneven_play(const common::EffectValues& values, MachineParameters& parameters) {
  const int count = parameters.crane.drive.group_count;
  for (int i = 0; i < count; ++i) {
    double& half_play = parameters.gear[i].half_play;
    half_play = std::max(0.0, half_play + 0.25 * values["difference"] * group_side(i, count));
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
                           .per = common::ScaleOf::gear_windup,
                           .meaning =
                               "whole play of the first half of the groups less that of the last, slew axis",
                           .lower = -3.255,
                           .upper = 3.255,
                           .typical = 0.8136,
                           .prior_scale = 0.3255,
                           .scale = common::ParameterScale::linear,
                           .absent = 0.0}},
           .needs = {.gears = true, .groups = 2},
           .family = common::Family::play},
      .ports = {EffectPort::parameters},
      .change = change_uneven_play};
  return description;
}

}  // namespace slewlab::sim
