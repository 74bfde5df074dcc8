// Torque ripple: on top of the command, a torque that depends on the rotor's angle,
//   T = T_command + a (sin(n theta_motor + phase) + second_sine sin(2 n theta_motor) + second_cosine cos(2 n theta_motor)),
// n ripples per turn of the motor. What acts over a step is its mean along the turned angle, exact for a steady speed, so
// that ripples faster than the step do not fold down into slow ones.
// Source: textbook; cogging and sixth harmonics of a three-phase machine, and their multiples. Left out in thesis 2.4.
#pragma once

#include "sim/effects/effect.h"

namespace slewlab::sim {

const EffectDescription& torque_ripple();

}  // namespace slewlab::sim
