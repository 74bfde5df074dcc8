// House compliance: the house twists between the slew ring, on which all pinions push, and the boom's pivot:
// two inertias on a spring,
//   J_ring theta_ring'' = sum T_gear - k_h (theta_ring - theta_h),
//   (J_h - J_ring) theta_h'' = k_h (theta_ring - theta_h) + T_boom.
// The ring is one more degree of freedom of the boom's modes: it costs one mode and is exact in the step.
// Unlike a softer gearbox it does not show when the groups push against each other.
// Source: thesis (2.9), 34.9 GNm/rad as printed, 69.8 corrected (erratum E5).
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& house_compliance();

}  // namespace slewlab::sim
