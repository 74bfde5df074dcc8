#include "controller/effects/speed_filter.h"

namespace slewlab::controller {

namespace {

void change(const std::vector<double>& values, ControllerSettings& settings) {
  settings.speed_filter_time += values[0];
}

}  // namespace

const ControllerEffect& speed_filter() {
  static const ControllerEffect effect{
      .about = {.name = "speed_filter",
                .subsystem = common::Subsystem::controller,
                .physics = "the measured speed is filtered",
                .parameters = {{.name = "time_constant",
                                .unit = common::Unit::second,
                                .meaning = "added to the one in the settings",
                                .lower = 0.0,
                                .upper = 0.3,
                                .typical = 0.05,
                                .prior_scale = 0.02,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0}}},
      .change = change};
  return effect;
}

}  // namespace slewlab::controller
