// Vessel roll: the vessel rolls by phi(t) = A sin(2 pi t / period + phase), downhill for positive phi at
// the angle psi from the boom's first direction. At the height z above the roll axis everything feels,
// across the boom,
//   f(z) = (g phi - z phi'') sin(psi - theta_house)  [m/s^2],
// the boom at the height of its middle, the load at its own. Small phi. Accelerometers read a - f(z).
// Source: textbook; thesis 1.1 names the period, 6 to 15 s, and leaves the motion out.
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& vessel_roll();

}  // namespace slewlab::sim
