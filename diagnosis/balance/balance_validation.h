// A choice of laws, judged by data that were not fitted: each block left out in turn, and, of several records, each whole record.
//
//   e_b = |y_b - A_b x_(without b)|^2 / n_b                                                           (1)
//
// Whole records judge where the others tell of each size a good share of what all do (least_share()). A law whose size has a sign that its physics forbids
// (friction that pushes), or that the records do not tell from its neighbours, makes the choice none that can be the answer.
//
// Units: squares of the axis's effort. Shapes: one entry per block of the regression, or per record.
// Source: cross-validation by blocks, Burman, Chow, Nolan 1994, Biometrika 81, p. 351.
#pragma once

#include <utility>
#include <vector>

#include "diagnosis/balance/balance_regression.h"

namespace slewlab::diagnosis {

inline constexpr double kLeastShare = kLawDiscrepancy * kLawDiscrepancy;  // of the gap, below which an addition is within a known law's residual

inline constexpr double kLeastDetermined = 0.1;  // of what all records tell of the sizes, that all but one tell as well, for that one to judge; chosen

// Mean squares of the residual on data that were not fitted.
struct LeftOutError {
  std::vector<double> block_error;         // of each block, left out on its own
  std::vector<double> record_block_error;  // of each block, its whole record left out; empty where the others do not determine the sizes
};

// Its sizes are fitted on everything.
struct ValidatedChoice : FittedChoice, LeftOutError {
  std::vector<double> record_error;          // of each record, left out whole; empty where the others do not determine the sizes
  double of_blocks = 0.0, of_records = 0.0;  // mean squares; of_records only where record_error is there
  bool is_physical = true;                   // no size has a sign that it cannot have, and all of them are determined
};
ValidatedChoice validate(const Regression& regression, const std::vector<BalanceLaw>& laws, const LawChoice& choice);

// Whether a law's sizes are such as its physics allows.
bool has_possible_sizes(const Regression& regression, const std::vector<BalanceLaw>& laws, const std::vector<Eigen::Index>& columns,
                        const std::pair<int, std::size_t>& chosen, const Eigen::VectorXd& sizes);

// The validation mean squares of two models by what both were validated by: their geometric mean of blocks and records, or blocks alone.
std::pair<double, double> compared(const ValidatedChoice& a, const ValidatedChoice& b);
bool is_better(const ValidatedChoice& a, const ValidatedChoice& b);

// Whether `with` predicts left-out data better than `without`: block by block, the mean fall more than kSignificance of its standard errors, and no
// whole record at the others' cost. `gap`: mean square of the residual of the inertia alone.
bool helps(const ValidatedChoice& without, const ValidatedChoice& with, double gap);

}  // namespace slewlab::diagnosis
