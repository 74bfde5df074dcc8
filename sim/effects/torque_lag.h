// Torque lag of the VFD: the motor's torque follows the command with a delay and a first-order lag behind it that share
// the time T_v,
//   tau dT/dt = T_command(t - T_d) - T,   T_d = delay_share T_v,   tau = (1 - delay_share) T_v,
// so that a ramp comes T_v late whatever the share. Several lags in a row lie between a share of 0 (one lag) and more
// delay. The delay takes the command from the two past steps around it, linearly. The lag is exact for a command held over
// the step: what acts is the mean over the step, with T_0 at its start
//   T_command + (T_0 - T_command) (tau / h) (1 - exp(-h / tau)).
// Source: thesis 2.3 (a proper VFD has about 10 ms and is left out there).
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& torque_lag();

}  // namespace slewlab::sim
