// Steady wind from one direction on boom and load: lateral forces
//   F = 1/2 rho v^2 (C A) sin(psi - theta_house),
// evenly along the boom and on the load; psi is where the wind blows to, from the boom's first direction. The
// crane's own speed against the air is left to air_drag.
// Source: textbook (drag on bluff bodies). Not in the thesis.
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& wind();

}  // namespace slewlab::sim
