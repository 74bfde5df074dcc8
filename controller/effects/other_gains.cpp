// Other gains: proportional gain and integral time are factors times what the settings say.
//   K_p' = gain_factor K_p,  T_i' = integral_time_factor T_i
// Source: thesis 3.5 (PI; its gains are not given).
#include "controller/effects/effect.h"

namespace slewlab::controller {

namespace {

void change(const common::EffectValues& values, ControllerSettings& settings) {
  settings.speed_control.proportional_gain *= values["gain_factor"];
  settings.speed_control.integral_time *= values["integral_time_factor"];
}

}  // namespace

const ControllerEffect& other_gains() {
  static const ControllerEffect effect{
      .about = {.name = "other_gains",
                .subsystem = common::Subsystem::controller,
                .physics = "the PI controller has other gains",
                .parameters = {{.name = "gain_factor",
                                .unit = common::Unit::none,
                                .meaning = "proportional gain over the one in the settings",
                                .lower = 0.2,
                                .upper = 5.0,
                                .typical = 1.5,
                                .prior_scale = 0.3,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = 1.0},
                               {.name = "integral_time_factor",
                                .unit = common::Unit::none,
                                .meaning = "integral time over the one in the settings",
                                .lower = 0.2,
                                .upper = 5.0,
                                .typical = 0.7,
                                .prior_scale = 0.3,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = 1.0}}},
      .change = change};
  return effect;
}

}  // namespace slewlab::controller
