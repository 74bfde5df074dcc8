// Softening by compression: the boom carries F_C along its axis, which takes bending stiffness away.
// (2.15) for a homogeneous boom,
//   f_C = f sqrt(1 - F_C / F_cr),   F_cr = pi^2 E I / L^2 (2.16),
// is the same as E I - F_C L^2 / pi^2 in place of E I. Taken at every station of the profile, so that the
// slender tip loses a larger share than the root: I falls by the half width, pi (D^2 - d^2) w^2. The polar
// inertia of the section is kept. Throws where a station would have no stiffness left.
// Source: thesis (2.15), (2.16); left out in 2.8 (at most 8.5 MN).
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& compression_softening();

}  // namespace slewlab::sim
