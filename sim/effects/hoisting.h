// Hoisting while slewing: the rope's length is L(t) = L_0 - s(t), s rising at the hoisting speed from
// `start` for `duration`. The speed is brought up and down within the ramp time t_r (or half the duration) as
//   v (3 (t / t_r)^2 - 2 (t / t_r)^3):
// a winch's drive has no steps of acceleration, and here they would strike the boom. In the absolute
// displacement y_1 of the load the small-angle equation is M y_1'' = -T (y_1 - y_tip) / L(t) with the tension
// T = M (g + s''), so that the difference to the constant rope is
//   F = -(M (g + s'') / L(t) - M g / L_0) (y_1 - y_tip)   on the load, and -F on the tip.
// L is kept at 2 m or more. Negative speed lowers.
// Source: textbook; thesis 5 names hoisting as future work.
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& hoisting();

}  // namespace slewlab::sim
