// Other ramp: acceleration and deceleration times are a factor times what the settings say, and the curved
// share of the S-curve is changed (kept within 0 ... 0.5). The emergency stop's ramp is kept.
//   t_accelerating' = time_factor t_accelerating,  t_decelerating' = time_factor t_decelerating,  share' = share + curved_share_change
// Source: thesis 4.5 (S-curve; its times scale with the speed).
#pragma once

#include "controller/effects/effect.h"

namespace slewlab::controller {

const ControllerEffect& other_ramp();

}  // namespace slewlab::controller
