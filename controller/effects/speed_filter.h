// Filter on the measured speed: a first-order low-pass with a time constant above the one in the settings.
//   T dv/dt = v_measured - v,  T = T_settings + time_constant
// Source: textbook; thesis Figure 3.16 has none.
#pragma once

#include "controller/effects/effect.h"

namespace slewlab::controller {

const ControllerEffect& speed_filter();

}  // namespace slewlab::controller
