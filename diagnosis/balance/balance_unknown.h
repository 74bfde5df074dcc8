// What no law of the catalogue explains: a smooth function under the same validation as the laws, of the effort beside the inertia ("unknown"),
// and of what a model leaves.
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

// What an inertia and smooth functions of speed and position leave of the effort.
LeftOutError unknown_validation(const std::vector<BalanceRecord>& records, const Regression& regression);

// Which of speed, position, time and torque the residual of a model follows most; none where that is hardly worth a word.
Remainder find_remainder(const std::vector<BalanceRecord>& records, const Regression& regression, const ValidatedChoice& best);

}  // namespace slewlab::diagnosis
