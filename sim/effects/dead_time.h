// Dead time of the drive: T(t) = T_command(t - delay).
// A command is held between steps; where the delay ends inside a step, the step gets the mean.
// Source: textbook; sampling and modulation of a VFD. The thesis neglects the VFD (2.3).
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& dead_time();

}  // namespace slewlab::sim
