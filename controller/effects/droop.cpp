#include "controller/effects/droop.h"

namespace slewlab::controller {

namespace {

void change(const std::vector<double>& values, ControllerSettings& settings) {
  settings.speed_control.droop += values[0];
}

}  // namespace

const ControllerEffect& droop() {
  static const ControllerEffect effect{
      .about = {.name = "droop",
                .subsystem = common::Subsystem::controller,
                .physics = "the speed reference falls with the torque",
                .parameters = {{.name = "droop",
                                .unit = common::Unit::radian_per_second,
                                .meaning = "fall of the shaft speed at rated torque",
                                .lower = 0.0,
                                .upper = 50.0,
                                .typical = 5.0,
                                .prior_scale = 2.0,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0}}},
      .change = change};
  return effect;
}

}  // namespace slewlab::controller
