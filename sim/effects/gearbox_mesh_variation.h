// Gearbox mesh variation: the stiffness of the gearbox's first planetary stage goes up and down with its
// mesh,
//   k(theta) = k (1 + a (sin(m + phase) + second_sine sin(2 m) + second_cosine cos(2 m))),   m = Z_r Z_s / (Z_r + Z_s) theta_motor.
// Z_r = 110, Z_s = 8 (Table 2.1) mesh at 150 Hz where the motor turns at 20 Hz. a is the share of the group's
// whole stiffness: small, because the fast stage's own compliance counts on the outgoing shaft by its ratio
// squared. Acts as the contact's torque (gear.h) at k(theta) less the one at k, on the house and back on the
// motor; the contact's damping stays (mesh_variation.h, mesh_torque.h). The mean over the turned angle of a
// step is taken, so that a mesh faster than the step does not fold down.
// Source: thesis (2.1), (2.2).
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& gearbox_mesh_variation();

}  // namespace slewlab::sim
