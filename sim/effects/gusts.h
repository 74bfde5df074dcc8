// Gusts: the wind's speed v + w(t) instead of v; what acts is the difference to the steady wind,
//   F = 1/2 rho (C A) ((v + w) |v + w| - v |v|) sin(psi - theta_house),
// on boom and load as in wind. w is a sum of 32 sines, 0.01 ... 5 Hz, with the spectrum of a first-order
// filter of the correlation time, its standard deviation as given, phases drawn from the seed: smooth, and
// the same for every step length.
// Source: textbook (superposition of harmonics). Not in the thesis.
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& gusts();

}  // namespace slewlab::sim
