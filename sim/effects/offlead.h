// Offlead by centrifugal force: slewing swings the load outwards by u,
//   u'' + 2 zeta w u' + w^2 u = r_tip omega^2 + u omega^2,   w^2 = g / L, omega = y_1' / r_tip,
// and the load, farther out, resists the slewing with its larger radius and by Coriolis,
//   F = -share M (u omega' + 2 u' omega)   on the load's lateral motion, omega' from the rope's pull.
// Source: textbook (motion in a turning frame); thesis 2.9 neglects the offlead.
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& offlead();

}  // namespace slewlab::sim
