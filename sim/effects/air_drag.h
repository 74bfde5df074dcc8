// Air drag of the load in still air: F = -1/2 rho (C A) |v| v with v the load's lateral velocity, slewing
// included.
// Source: textbook (drag on bluff bodies). Not in the thesis.
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& air_drag();

}  // namespace slewlab::sim
