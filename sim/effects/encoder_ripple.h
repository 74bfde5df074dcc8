// Encoder ripple: a disk mounted off its centre reads wrong once per turn,
//   position += a sin(position + phase),   speed (1 + a cos(position + phase)).
// Encoders are mounted one by one, so the phase of the last half of the groups is its own.
// Source: textbook (eccentric encoder disk). Not in the thesis.
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& encoder_ripple();

}  // namespace slewlab::sim
