// Sizes of the laws of a model, as they are stated and as they predict.
//
//   var(x) = e n / N (sum of A_b^T A_b + R)^-1                                                        (1)
//
// e: mean square on blocks left out, n: samples, N: independent ones among them (n over the residual's correlation length); A, R as of
// balance_regression.h.
//
// Stated are the sizes of the named laws alone. What predicts is fitted beside those ordinary laws that are not named (`details`), where none is
// named too: every machine has a little of them, and what predicts must not do worse than least squares with all of them.
#pragma once

#include <vector>

#include "diagnosis/balance/balance_model.h"
#include "diagnosis/balance/balance_validation.h"

namespace slewlab::diagnosis {

// The model of a choice with its sizes and (1). `independent`: N.
BalanceModel to_model(const Regression& regression, const std::vector<BalanceLaw>& laws, const ValidatedChoice& validated, double independent);

// With the ordinary laws that are not named, where the records tell them from those that are. Those go again that would push.
ValidatedChoice with_details(const Regression& regression, const std::vector<BalanceLaw>& laws, const ValidatedChoice& named);
// Which of the terms of `other` are details, and how sure they are, as in `model`.
void take_details(const BalanceModel& model, BalanceModel& other);
// What is stated of a law's size, fitted without the details, is known no better than these move it.
void widen(const BalanceModel& with_details, BalanceModel& stated);

// Sizes of the same laws: beside their details, with which the axis is predicted; and as they are stated, without details, known no better than these
// move them.
struct FittedSizes {
  BalanceModel best, stated;
  bool is_physical = true;  // no size has a sign that its law cannot have, and the records determine all of them
  Remainder remainder;      // of `best`
  double rest = 0.0;        // RMS of the residual of `best` on these records
};
// The same laws in the same shapes, their sizes fitted to other records. Throws std::invalid_argument where these do not move enough for a balance, or
// `laws` lack one of the model's. `motor_angle` as of balance_unknown.h.
FittedSizes refitted(const std::vector<BalanceRecord>& records, const std::vector<BalanceLaw>& laws, const BalanceModel& model,
                     double nominal_inertia, double resolved_speed, double motor_angle = 0.0);

}  // namespace slewlab::diagnosis
