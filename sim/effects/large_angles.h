// Large angles: the rope's true sideways pull in place of its small-angle one. With sin(beta) = (y_1 -
// y_tip) / L the tension is T = M (g cos(beta) + L beta'^2 - y_tip'' sin(beta)), so that the load feels
// besides M g sin(beta)
//   F = -share M sin(beta) (g (cos(beta) - 1) + L beta'^2 - y_tip'' sin(beta)),   the tip -F.
// The rod keeps its small angles. share 1 is the whole nonlinearity, 0 none.
// Source: textbook (pendulum with a moved support); thesis 3.3.3 takes small angles.
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& large_angles();

}  // namespace slewlab::sim
