// Pinion mesh variation: the stiffness of the teeth in contact goes up and down with the mesh,
//   k(theta) = k (1 + a (sin(m + phase) + second_sine sin(2 m) + second_cosine cos(2 m))),   m = Z_p i_pinion theta_house,
// second_sine and second_cosine because teeth take over with corners, not with a sine. The pinion turns with
// the house; the gearbox gives between it and the motor.
// Z_p = 12 teeth (Table 2.1) mesh at 1.2 Hz where the pinion turns at 0.1 Hz. a is the share of the group's
// whole stiffness: 20 % of the pinion's (2.7) in series with the gearbox is
// a = 0.2 k_gearbox / (k_gearbox + k_pinion). Acts as the contact's torque (gear.h) at k(theta) less the one at
// k, on the house and back on the motor; the contact's damping stays (mesh_variation.h, mesh_torque.h).
// Source: thesis (2.1), (2.3).
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& pinion_mesh_variation();

}  // namespace slewlab::sim
