// What no law of the catalogue explains: a smooth function under the same validation as the laws, of the effort beside the inertia ("unknown"),
// and of the residual of a model.
//
//   f(v) = sum over k of c_k exp(-((v - v_k) / w)^2 / 2)                                              (1)
//
// kBumps centres v_k evenly over the range of the variable, w apart; c by ridge regression.
// Shapes: LeftOut as of balance_validation.h, one entry per block. Units: squares of the axis's effort.
#pragma once

#include <vector>

#include "diagnosis/balance/balance_model.h"
#include "diagnosis/balance/balance_validation.h"

namespace slewlab::diagnosis {

// The residual of an inertia and smooth functions of speed and position, fitted to the effort.
LeftOutError unknown_validation(const std::vector<BalanceRecord>& records, const Regression& regression);

// What the residual of a model follows most; nothing where that is hardly worth a word. Tried are smooth functions of speed, position and time, of the
// torque that the model asks for (the measured one holds the residual itself), of position, time and that torque against the motion, sines of the
// motor's angle, these times the torque, and, of several records, what differs from one to the next as a constant torque, a friction or an
// inertia. `motor_angle` [rad]: turn of the motor per unit of the axis; 0: no motor turns.
Remainder find_remainder(const std::vector<BalanceRecord>& records, const Regression& regression, const FittedChoice& best, double motor_angle = 0.0);

}  // namespace slewlab::diagnosis
