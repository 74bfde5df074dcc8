// Tag line: a line from the load to a winch on the crane house keeps the load from swinging,
//   F = -k (y_1 - r_tip theta_house) - c (y_1' - r_tip omega_house)
// on the load, and the moment -F r_tip on the house. It pulls against the house's rotation, not against the
// bending boom.
// Source: textbook; not in the thesis.
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& tag_line();

}  // namespace slewlab::sim
