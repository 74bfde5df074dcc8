// Droop in the drives that the settings know nothing of: the speed reference of a group falls by k T / T100.
// Source: thesis 2.3 and appendix D (as the notes give it); off in the thesis's model.
#include "controller/effects/effect.h"

namespace slewlab::controller {

namespace {

void change(const common::EffectValues& values, ControllerSettings& settings) {
  settings.speed_control.droop += values["droop"];
}

}  // namespace

const ControllerEffect& droop() {
  static const ControllerEffect effect{
      .about = {.name = "droop",
                .subsystem = common::Subsystem::controller,
                .physics = "the speed reference falls with the torque",
                .parameters = {{.name = "droop",
                                .unit = common::Unit::radian_per_second,
                                .per = common::ScaleOf::motor_speed,
                                .meaning = "fall of the shaft speed at rated torque",
                                .lower = 0.0,
                                .upper = 0.3656,
                                .typical = 0.03656,
                                .prior_scale = 0.01462,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0}}},
      .change = change};
  return effect;
}

}  // namespace slewlab::controller
