// Pinion in series: the teeth of pinion and ring are a spring behind the gearbox,
//   1/k = 1/k_gearbox + 1/k_pinion,   c = c_gearbox s (s + d (1 - s)),   s = k_pinion / (k_gearbox + k_pinion).
// Two damped springs in series, far below their own frequencies. d, `damping_share`, is the loss factor of the teeth over
// the gearbox's, c_pinion / k_pinion = d c_gearbox / k_gearbox: 0 is a bare spring, 1 keeps the gearbox's loss factor.
// What teeth damp is not known.
// Source: thesis (2.7), 713 MNm/rad per pinion for Table 2.2; section 2.6.2 takes it as rigid.
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& pinion_in_series();

}  // namespace slewlab::sim
