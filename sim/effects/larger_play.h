// Larger play: every gear has more play than the crane's file says,
//   Delta_b = Delta_b,nominal + added / 2,   added: whole play on the slew axis.
// Source: thesis 2.6.1 (wear; 2-4 % of the module is what a new pinion has).
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& larger_play();

}  // namespace slewlab::sim
