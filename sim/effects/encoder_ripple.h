// Encoder ripple: a disk mounted off its centre reads wrong once per turn, and an oval one twice,
//   position += a (sin(p) - sin(phase) + s (sin(2 p) - sin(2 phase))),   p = position + phase,
//   speed (1 + a (cos(p) + 2 s cos(2 p))):
// both belong to one disk, so that one phase places both. It reads 0 where it starts.
// Encoders are mounted one by one, so the phase of the last half of the groups is its own.
// Source: textbook (eccentric encoder disk). Not in the thesis.
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& encoder_ripple();

}  // namespace slewlab::sim
