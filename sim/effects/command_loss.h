// Command loss: messages are lost in bursts, and the drives hold the last one that arrived. Where no burst is on, one
// begins at each message with the probability
//   q = p / (burst (1 - p) + p)
// and takes `burst` messages in a row (rounded to a whole number); another may begin right behind it. So the share that is
// lost is p for every burst, and the stretches that are lost have the mean length burst + p / (1 - p); a burst of 1 is
// independent loss, q = p. A message is known by its sequence; before the first arrives there is no torque.
// Source: textbook (lossy bus; renewals for share and length). Not in the thesis.
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& command_loss();

}  // namespace slewlab::sim
