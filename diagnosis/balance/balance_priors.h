// Priors of what every machine and recorder has a little of: normal, about 0 but for the inertia, against the residual of the ordinary laws.
//
//   inertia                                         kInertiaPrior of the file's, about that
//   skew between the channels                       kSkewPrior of a sample and kDriveLag of the motion's time
//   viscous friction's difference of the directions kLean of it
//
//   R_kk = s^2 / p_k^2                                                                                (1)
//
// in equation (1) of balance_regression.h; p_k: standard deviation of the prior, s^2: mean square of the ordinary laws' residual times the
// samples over which it goes together. So records in which an axis hardly changes its speed leave the inertia where the file has it.
#pragma once

#include <vector>

#include "diagnosis/balance/balance_regression.h"

namespace slewlab::diagnosis {

// The regression of these records with its priors. Throws std::invalid_argument where the records do not move enough for a balance.
Regression prepared_regression(const std::vector<BalanceRecord>& records, const std::vector<BalanceLaw>& laws, double nominal_inertia,
                               double resolved_speed);

}  // namespace slewlab::diagnosis
