// Torque lag of the VFD: the motor's torque follows the command with a first-order lag,
//   tau dT/dt = T_command - T.
// Exact for a command held over the step: what acts is the mean over the step,
//   T_command + (T_0 - T_command) (tau / h) (1 - exp(-h / tau)).
// Source: thesis 2.3 (a proper VFD has about 10 ms and is left out there).
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& torque_lag();

}  // namespace slewlab::sim
