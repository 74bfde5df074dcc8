// Heel: the vessel lies inclined by phi, downhill at the angle psi from the boom's first direction.
// Gravity then has a part across the boom,
//   f = g sin(phi) sin(psi - theta_house)  [m/s^2],
// on every mass of boom, load and rod; the house's centre of mass lies on the axis. An accelerometer
// cannot tell gravity from motion: it reads a - f. The loss of gravity along the rope, 1 - cos(phi), is
// left out.
// Source: textbook; thesis 1.1 names "static heel of the crane" as part of the current calculations.
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& heel();

}  // namespace slewlab::sim
