// Pinion mesh variation: the stiffness of the teeth in contact goes up and down with the mesh,
//   k(theta) = k (1 + a sin(Z_p i_pinion theta_house + phase)).
// Z_p = 12 teeth (Table 2.1) mesh at 1.2 Hz where the pinion turns at 0.1 Hz. a is the share of the group's
// whole stiffness: 20 % of the pinion's (2.7) in series with the gearbox is
// a = 0.2 k_gearbox / (k_gearbox + k_pinion). Acts as the torque a sin(..) T_gear on the house, and back on
// the motor; T_gear is the torque of the constant stiffness.
// Source: thesis (2.1), (2.3).
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& pinion_mesh_variation();

}  // namespace slewlab::sim
