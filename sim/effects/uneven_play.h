// Uneven play: the first half of the motor groups has more play, the last half less, by the difference d
// of whole plays on the slew axis,
//   Delta_b,i = max(0, Delta_b + d / 4), max(0, Delta_b - d / 4).   One group has no difference.
// Source: thesis 2.4 and 2.6.1 (spread between drives; pinions are set one by one).
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& uneven_play();

}  // namespace slewlab::sim
