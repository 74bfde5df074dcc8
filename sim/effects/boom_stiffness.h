// Boom stiffness: bending and torsion stiffness are factor times the nominal ones (E and G), so that every
// frequency of the clamped boom goes with the square root of the factor. The damping ratio is kept.
//   E' = factor E,  G' = factor G,  f_i' = sqrt(factor) f_i
// Source: thesis 2.8 (chords only, bracings left out; (2.11)).
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& boom_stiffness();

}  // namespace slewlab::sim
