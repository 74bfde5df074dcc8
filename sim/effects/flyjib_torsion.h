// Eccentric torsion of a fly jib: a jib of mass m on the boom's tip, its centre and its sheave the
// distance e in front of the boom's axis. It moves with y_tip + e psi_tip, so that bending and torsion are
// coupled at the tip,
//   M_tip += m [1 e; e e^2] on [y, psi],
// and the rope hangs from there. The tip accelerometer stays on the boom's own tip, y_tip. Rigid jib;
// BoomParameters::jib_mass, jib_eccentricity.
// Source: textbook; the thesis's boom has no jib.
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& flyjib_torsion();

}  // namespace slewlab::sim
