// Other ramp: acceleration and deceleration times are a factor times what the settings say, and the curved
// share of the S-curve is changed (kept within 0 ... 0.5). The emergency stop's ramp is kept.
//   t_accelerating' = time_factor t_accelerating,  t_decelerating' = time_factor t_decelerating,  share' = share + curved_share_change
// Source: thesis 4.5 (S-curve; its times scale with the speed).
#include "controller/effects/effect.h"

#include <algorithm>

namespace slewlab::controller {

namespace {

void change(const common::EffectValues& values, ControllerSettings& settings) {
  settings.ramp.acceleration_time *= values["time_factor"];
  settings.ramp.deceleration_time *= values["time_factor"];
  settings.ramp.curved_share = std::clamp(settings.ramp.curved_share + values["curved_share_change"], 0.0, 0.5);
}

}  // namespace

const ControllerEffect& other_ramp() {
  static const ControllerEffect effect{
      .about = {.name = "other_ramp",
                .subsystem = common::Subsystem::controller,
                .physics = "the ramp takes another time or has another shape",
                .parameters = {{.name = "time_factor",
                                .unit = common::Unit::none,
                                .meaning = "acceleration and deceleration time over those in the settings",
                                .lower = 0.3,
                                .upper = 3.0,
                                .typical = 1.3,
                                .prior_scale = 0.2,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = 1.0},
                               {.name = "curved_share_change",
                                .unit = common::Unit::none,
                                .meaning = "added to the curved share",
                                .lower = -0.5,
                                .upper = 0.5,
                                .typical = 0.0,
                                .prior_scale = 0.1,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0}}},
      .change = change};
  return effect;
}

}  // namespace slewlab::controller
