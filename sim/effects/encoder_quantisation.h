// Encoder quantisation: the position comes in steps of the resolution r, position_q = r floor(position /
// r), and the speed from counts over a window w,
//   speed_q(t) = speed(t) + (e(t) - e(t - w)) / w,   e = position_q - position,
// which is the count's difference over w where the window is short against the motion.
// Source: textbook (incremental encoder). Not in the thesis.
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& encoder_quantisation();

}  // namespace slewlab::sim
