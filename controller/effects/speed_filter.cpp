// Filter on the measured speed: a first-order low-pass with a time constant above the one in the settings.
//   T dv/dt = v_measured - v,  T = T_settings + time_constant
// Source: textbook; thesis Figure 3.16 has none.
#include "controller/effects/effect.h"

namespace slewlab::controller {

namespace {

void change(const common::EffectValues& values, ControllerSettings& settings) {
  settings.speed_filter_time += values["time_constant"];
}

}  // namespace

const ControllerEffect& speed_filter() {
  static const ControllerEffect effect{
      .about = {.name = "speed_filter",
                .subsystem = common::Subsystem::controller,
                .physics = "the measured speed is filtered",
                .parameters = {{.name = "time_constant",
                                .unit = common::Unit::second,
                                .per = common::ScaleOf::time,
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
