// Viscous friction of the slew bearing:
//   T = -d (1 + a) omega_house for positive speed, -d (1 - a) omega_house for negative.
// Source: textbook (grease film). Not in the thesis.
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& bearing_viscous();

}  // namespace slewlab::sim
