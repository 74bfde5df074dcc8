// Load-dependent gear friction: the teeth lose a share of the torque they carry, as friction on the motor
// side,
//   |T_friction| <= loss |T_gear|,   against the motor's motion, and holding at rest.
// loss = 1 - efficiency.
// Source: thesis 2.6 (friction between the teeth lowers the efficiency; neglected there).
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& gear_friction();

}  // namespace slewlab::sim
