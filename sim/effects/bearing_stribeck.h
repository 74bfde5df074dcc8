// Stribeck friction of the slew bearing: dry friction that falls from its breakaway value as motion begins,
//   |T| <= (1 +- a) (T_c + T_s exp(-(omega / omega_s)^2)),   + against positive motion,
// holding at rest. T_s is the excess of breakaway over sliding. With `give` > 0 as bearing_coulomb.h.
// Source: textbook (Stribeck curve); bearing friction is not in the thesis.
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& bearing_stribeck();

}  // namespace slewlab::sim
