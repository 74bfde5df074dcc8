// House inertia: the crane house is heavier than its closed form says, J_h = factor J_h,nominal.
// Machinery, cabin and counterweight stand outside the thin tube of (2.8).
// Source: thesis (2.8), Table 2.3; called negligible in 2.10.
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& house_inertia();

}  // namespace slewlab::sim
