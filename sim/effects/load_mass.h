// Load mass: the load is factor times as heavy as told, M_l = factor M_l,nominal.
// Source: thesis 3.3.3; the load's mass is what the operator was told.
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& load_mass();

}  // namespace slewlab::sim
