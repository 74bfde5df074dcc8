// Hydraulic compliance: the oil column of a hydraulic drive is a damped spring in series with the gearbox,
//   1/k = 1/k_gearbox + 1/k_oil,
//   c = c_gearbox (k_oil / (k_gearbox + k_oil))^2 + c_oil (k_gearbox / (k_gearbox + k_oil))^2,
// two damped springs in series far below their own frequencies. Per group, on the slew axis.
// Source: thesis 1.1 (the Sleipnir's drive: "an additional stiffness as a result of the oil").
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& hydraulic_compliance();

}  // namespace slewlab::sim
