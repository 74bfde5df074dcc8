// Uneven motor inertia: the first half of the motor groups has more, the last half less,
//   J_i = J (1 + s), J (1 - s).
// The middle one of an odd number of groups keeps its own. One group has no difference.
// Source: thesis 2.4, first cause of an uneven load distribution (small deviations between drives).
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& uneven_motor_inertia();

}  // namespace slewlab::sim
