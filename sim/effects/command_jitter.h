// Command jitter: every message takes a time of its own to arrive, evenly drawn from 0 ... spread, at
// whole steps; a message never overtakes an older one. A message is known by its sequence.
//   arrival_k = max(arrival_(k-1), t_k + spread u_k),  u_k drawn evenly from 0 ... 1, in whole steps
// Source: textbook (shared bus). Not in the thesis.
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& command_jitter();

}  // namespace slewlab::sim
