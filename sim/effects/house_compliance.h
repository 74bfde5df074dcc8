// House compliance: the house twists between the slew ring, where all pinions push, and the boom's pivot.
// One spring k_h behind all gears together: with S the sum of the gears' torques the ring leads the house
// by S / k_h, and every gear in contact carries
//   T_i = T_i,rigid - k_i x,   x = sum T_i,rigid / (k_h + sum over gears in contact of k_i).
// The ring's own inertia is left out (59 ... 84 Hz, thesis 2.7). Unlike a softer gearbox it does not show
// when the groups push against each other.
// Source: thesis (2.9), 34.9 GNm/rad as printed, 69.8 corrected (erratum E5).
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& house_compliance();

}  // namespace slewlab::sim
