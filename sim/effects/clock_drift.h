// Clock drift: accelerometers and slew angle are sampled by a clock that runs slow against the drives', so
// that what is stamped t was measured at t - drift t, linear between steps. The lag is kept at 1 s or
// less.
// Source: textbook (clocks of two devices). Not in the thesis.
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& clock_drift();

}  // namespace slewlab::sim
