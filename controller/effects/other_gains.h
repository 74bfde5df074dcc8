// Other gains: proportional gain and integral time are factors times what the settings say.
//   K_p' = gain_factor K_p,  T_i' = integral_time_factor T_i
// Source: thesis 3.5 (PI; its gains are not given).
#pragma once

#include "controller/effects/effect.h"

namespace slewlab::controller {

const ControllerEffect& other_gains();

}  // namespace slewlab::controller
