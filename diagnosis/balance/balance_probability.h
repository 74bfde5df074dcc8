// How probable each set of laws is, by its residual on data that were not fitted.
//
// With x_b the logarithm of the ratio of two models' mean squares of the residual on block b, both above (kLawDiscrepancy of the gap's amplitude)^2,
// m its mean over n blocks and s its standard error, kRatioDeviation added,
//
//   ln odds = -(n / 2) ln(1 + (m / s)^2 / (n - 1)) sign(m)                                            (1)
//
// each law more at its prior. So what counts is whether a law helps everywhere, not how often its help was sampled. Student's density of a mean
// whose spread is not known: Gelman and others 2013, Bayesian Data Analysis, ch. 3.
#pragma once

#include <cstddef>
#include <vector>

#include "diagnosis/balance/balance_validation.h"

namespace slewlab::diagnosis {

// Equation (1), of one model against another. What laws are known no better than (`floor`, a mean square) is part of both residuals.
double log_odds(const LeftOutError& one, const LeftOutError& other, double floor);

struct SetProbabilities {
  std::vector<double> probability;  // of each candidate
  std::vector<double> inclusion;    // of each law, over all candidates
  double unknown = 0.0;
  std::size_t answer = 0;           // index of the candidate that is the answer
};
// `alone`: the inertia alone; `unknown`: the residual of a smooth function.
SetProbabilities set_probabilities(const std::vector<ValidatedChoice>& candidates, const std::vector<BalanceLaw>& laws, const Regression& regression,
                                   const ValidatedChoice& alone, const LeftOutError& unknown);

}  // namespace slewlab::diagnosis
