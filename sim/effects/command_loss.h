// Command loss: a message is lost with the given probability; the drives hold the last one that arrived. A
// message is known by its sequence; before the first arrives there is no torque.
// Source: textbook (lossy bus). Not in the thesis.
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& command_loss();

}  // namespace slewlab::sim
