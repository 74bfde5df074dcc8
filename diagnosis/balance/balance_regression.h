// The torque balance as linear least squares: a column for the acceleration, one for the recorder's skew, and one for each size of each law in
// each of its shapes, at the samples that move.
//
//   (sum of A_b^T A_b + R) x = sum of A_b^T y_b + R x_0                                               (1)
//
// A_b, y_b: columns and efforts of block b; R: diagonal, what the columns' priors add (balance_priors.h); x_0: the file's inertia, 0 elsewhere. A
// block is several stretches spread over its record: what is left out with it is no motion that the rest does not have. Its sums are everything
// that a fit and its error need, so a fit costs nothing per sample.
//
// What a lag withholds is made of the recorded efforts, and so are the efforts it has to explain: white noise of theirs would explain itself. Its
// part, known by its size (balance_record.h), is taken out of the products and out of those with the effort (Fuller 1987, Measurement Error
// Models, ch. 2); it stays in the square, so that a column neither gains nor loses by it.
//
// Shapes: A has a row per judged sample and a column per Regression::columns; sums are square in the columns that were chosen.
// Units: those of the axis (balance_laws.h); solved with columns brought to one size, so that units do not matter.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "diagnosis/balance/balance_laws.h"

namespace slewlab::diagnosis {

// Blocks left out in turn.
inline constexpr int kBlocksPerRecord = 10;
inline constexpr int kStretchesPerBlock = 4;
// First row and number of rows of the stretches of a block.
std::vector<std::pair<Eigen::Index, Eigen::Index>> stretches_of(int block, Eigen::Index rows);

// One column of the regression and where it belongs.
inline constexpr int kAcceleration = -1, kSkew = -2;  // of no law
inline constexpr Eigen::Index kSkewColumn = 1;        // behind the acceleration's
struct RegressionColumn {
  int law = kAcceleration;
  std::size_t shape = 0;
  bool is_noise = false;  // most of it is what noise of the efforts makes: it tells nothing
};

// Sums over one block: everything that a least-squares fit and its error need.
struct RegressionBlock {
  std::size_t record = 0;
  double count = 0.0, square = 0.0;
  Eigen::MatrixXd products;
  Eigen::VectorXd with_effort;
};

struct Regression {
  std::vector<RegressionColumn> columns;
  Eigen::VectorXd ridge;                  // of each column: what its prior adds to the products
  double nominal_inertia = 0.0;           // about which the acceleration's prior is; those of the others are about 0
  std::vector<RegressionBlock> blocks;
  std::vector<Eigen::MatrixXd> values;    // per record, judged samples
  std::vector<Eigen::VectorXd> efforts;
  std::vector<std::vector<std::size_t>> judged;  // indices into the record
  double count = 0.0, all = 0.0;
  bool is_skewed = false;  // the effort changes, so that a skew shows
  std::vector<bool> acts_late;  // of each law
};

// Priors are none yet. Throws std::invalid_argument where the records do not move enough for a balance.
Regression make_regression(const std::vector<BalanceRecord>& records, const std::vector<BalanceLaw>& laws, double resolved_speed);

// Some of the laws, each in one of its shapes.
struct LawChoice {
  std::vector<std::pair<int, std::size_t>> laws;  // law, shape
};
// A law's choice in its first shape; nothing where it is not among the laws.
std::optional<std::pair<int, std::size_t>> chosen_law(const std::vector<BalanceLaw>& laws, std::string_view name);
// The acceleration's, the skew's where the effort changes and no drive acts late, and the laws'.
std::vector<Eigen::Index> columns_of(const Regression& regression, const LawChoice& choice);

// Both sides of (1) over the blocks that are in; over all of them.
struct RegressionSums {
  Eigen::MatrixXd products;
  Eigen::VectorXd with_effort;
};
RegressionSums sums_of(const Regression& regression, const std::vector<Eigen::Index>& columns, const std::function<bool(const RegressionBlock&)>& is_in);
RegressionSums sums_of(const Regression& regression, const std::vector<Eigen::Index>& columns);

// x of (1).
Eigen::VectorXd solve(const RegressionSums& sums);
// Smallest eigenvalue of the products of columns brought to one size: 0 where some of them are parallel.
double least_determined(const RegressionSums& sums);
// Of what `whole` tells of its sizes, the share that `part` tells as well, of that combination of them of which it tells least.
double least_share(const RegressionSums& part, const RegressionSums& whole);
// Sum of squares of the residual of these sizes on a block.
double squared_error(const RegressionBlock& block, const std::vector<Eigen::Index>& columns, const Eigen::VectorXd& sizes);

// A choice of laws with the size of each of its columns.
struct FittedChoice {
  LawChoice choice;
  Eigen::VectorXd sizes;
};
// At the judged samples of a record.
Eigen::VectorXd residual_of(const Regression& regression, const FittedChoice& model, std::size_t record);
// [samples] over which the residual of neighbours goes together: the integral of its autocorrelation up to where that first falls to 0.
double correlation_length(const Regression& regression, const FittedChoice& model);

}  // namespace slewlab::diagnosis
