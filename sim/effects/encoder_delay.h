// Encoder delay: position and speed arrive late, x(t - delay), linear between steps.
// Source: textbook (filtering and bus cycle of an encoder interface). Not in the thesis.
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& encoder_delay();

}  // namespace slewlab::sim
