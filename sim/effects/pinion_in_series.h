// Pinion in series: the teeth of pinion and ring are a spring behind the gearbox,
//   1/k = 1/k_gearbox + 1/k_pinion,   c = c_gearbox (k_pinion / (k_gearbox + k_pinion))^2.
// A damped spring and a bare one in series, far below their own frequencies.
// Source: thesis (2.7), 713 MNm/rad per pinion for Table 2.2; section 2.6.2 takes it as rigid.
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& pinion_in_series();

}  // namespace slewlab::sim
