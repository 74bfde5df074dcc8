// Whether what a stochastic effect would have drawn answers to each command in the same way, and so is a law that nobody draws: a drive that lags the one way alone, that
// follows quick changes less than slow ones, or that is the later the faster it turns has about the power of commands that come late by chance.
//
// The torque that is missing then is a sum of what the commands T have changed by over the last windows w, each with a factor m of its own,
//
//   sum over w and m of a_wm m(t) (T(t) - T(t - w)),    w = 1, 2, 4, ... rows up to half of the characteristic time,
//
// m being 1, the rising or the growing ones alone, the change's own size, or the axis's speed. What such a sum leaves of the gap is compared with what it leaves of
// the changes by draws: of these it takes the mean away, and what differs from one command to the next stays.
// Assumption: torques so small that their changes of the differences add up.
#pragma once

#include "diagnosis/fit.h"

namespace slewlab::diagnosis {

// Sums of squares over the number of differences, above the noise.
struct LawInDraws {
  double left = 0.0;           // of the gap, by the sum
  double left_of_draws = 0.0;  // of the draws' changes, the mean of several
  // One draw leaves as much as another within a factor of two; a law leaves what its windows and factors are not, a tenth as a rule.
  bool is_law() const { return left < left_of_draws / 3.0; }
};

// Of a fit with a stochastic effect: some forty simulations. Throws Interrupted.
LawInDraws law_in_draws(Problem& problem, const FitResult& fit);

}  // namespace slewlab::diagnosis
