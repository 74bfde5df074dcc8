// Other play-compensation map: the two halves differ from the average torque by a factor times what the
// map says,
//   T_i = average + factor (T_i,map - average).
// A map that is switched off stays off; factor 0 takes the offset away.
// Source: thesis 3.5, Table 3.4.
#pragma once

#include "controller/effects/effect.h"

namespace slewlab::controller {

const ControllerEffect& other_play_compensation();

}  // namespace slewlab::controller
