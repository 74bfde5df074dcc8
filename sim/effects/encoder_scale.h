// Encoder scale: position and speed read (1 + error) times what they are (counts per turn or ratio set
// wrong).
// Source: textbook. Not in the thesis.
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& encoder_scale();

}  // namespace slewlab::sim
