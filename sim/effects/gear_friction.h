// Load-dependent gear friction: the teeth lose a share of the torque they carry, on the motor side and against the
// motor's motion,
//   T_friction = -loss |T_gear| x / sqrt(1 + x^2),   x = motor_speed / sliding_speed.
// loss = 1 - efficiency. Teeth slide back and forth through the pitch point and never hold still together, so that the
// friction of all passes zero smoothly with the speed: it holds nothing at rest.
//
// Acts from the middle of the step, explicitly; stable while loss |T_gear| step < sliding_speed J_group. With both numbers
// at their worst bounds, 1 ms and the thesis's drives that is to 3.3 MNm per group, 400 Nm of each motor.
// Source: thesis 2.6 (friction between the teeth lowers the efficiency; neglected there). The smooth passage is this
// project's.
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& gear_friction();

}  // namespace slewlab::sim
