// Steady wind from one direction on boom and load, quasi-steady: lateral forces
//   F = 1/2 rho (C A) (v^2 sin a - v u (1 + sin^2 a)),    a = psi - theta_house,
// evenly along the boom and on the load; psi is where the wind blows to, from the boom's first direction, u the crane's own
// lateral speed, of the boom's middle as it turns and of the load. That is the drag of the relative wind across the boom to
// first order in u: the wind damps what moves in it. The drag of own speeds in still air is left to air_drag.
// Source: textbook (drag on bluff bodies; aerodynamic damping of quasi-steady wind loads). Not in the thesis.
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& wind();

}  // namespace slewlab::sim
