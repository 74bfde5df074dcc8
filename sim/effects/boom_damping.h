// Boom damping: the damping ratio at the boom's first two bending modes is factor times the nominal one,
// (3.15).
//   zeta_i' = factor zeta_i, i = 1, 2
// Source: thesis 3.3.2 (structural damping; its ratio is not given).
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& boom_damping();

}  // namespace slewlab::sim
