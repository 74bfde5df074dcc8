// Coulomb friction of the slew bearing: a torque of constant size against the house's motion, holding at
// rest,
//   |T| <= T_c (1 + a) against positive motion, T_c (1 - a) against negative.
// With `give` > 0 the bearing gives before it slides (presliding.h): torque T_c (1 +- a) s, + where the held share s is
// positive. That is continuous at s = 0, and more angle is more torque for every a.
// Source: textbook; "static friction" is in the calculations that thesis 1.1 calls current, and not in its
// model.
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& bearing_coulomb();

}  // namespace slewlab::sim
