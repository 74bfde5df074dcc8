// Dragging brake: brakes that do not open fully rub on the motors with a torque that does not depend on
// speed,
//   |T_friction| <= T_drag (1 + u) n_motors i   on the first half of the groups, (1 - u) on the last,
// against the motion, and holding at rest.
// With `give` > 0 each brake gives before it slides (presliding.h); `give` is an angle of the motor.
// Source: thesis 2.5 (brake plates; their details are left out there).
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& dragging_brake();

}  // namespace slewlab::sim
