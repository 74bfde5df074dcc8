// Torque limit: the drive delivers no more than T_max, whatever it is told,
//   T = clamp(T_command, -T_max, T_max).
// With `knee` w > 0 it yields before: |T| follows the command up to (1 - w) T_max and goes on, with the same slope, as
//   (1 - w) T_max + w T_max tanh((|T_command| - (1 - w) T_max) / (w T_max)).
// Source: every drive has a current limit; the thesis assumes that it is never met (2.4).
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& torque_limit();

}  // namespace slewlab::sim
