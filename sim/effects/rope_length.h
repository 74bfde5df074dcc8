// Rope length: the rope is factor times as long as told, so that the swing's frequency goes with its inverse
// square root (2.17).
// Source: thesis (2.17).
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& rope_length();

}  // namespace slewlab::sim
