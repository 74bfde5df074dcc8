#include "diagnosis/balance/balance_validation.h"

#include <algorithm>
#include <cmath>

namespace slewlab::diagnosis {

namespace {

constexpr double kSignificance = 2.0;     // [standard errors] by which an addition must help the left-out blocks
constexpr double kParallel = 1e-4;        // smallest eigenvalue of the columns' products, from which records tell the laws of a model apart

// The columns whose sizes the records must tell: a difference of the directions has its prior, without which records of one direction would
// tell no viscous friction.
std::vector<Eigen::Index> told_by_records(const Regression& regression, const std::vector<BalanceLaw>& laws, const std::vector<Eigen::Index>& columns) {
  std::vector<Eigen::Index> told;
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const RegressionColumn& column = regression.columns[static_cast<std::size_t>(columns[k])];
    const bool is_second = k > 0 && column.law >= 0 && regression.columns[static_cast<std::size_t>(columns[k - 1])].law == column.law;
    if (is_second && laws[static_cast<std::size_t>(column.law)].shapes[column.shape].is_leaning) continue;
    told.push_back(columns[k]);
  }
  return told;
}

}  // namespace

bool has_possible_sizes(const Regression& regression, const std::vector<BalanceLaw>& laws, const std::vector<Eigen::Index>& columns,
                        const std::pair<int, std::size_t>& chosen, const Eigen::VectorXd& sizes) {
  const BalanceLaw& law = laws[static_cast<std::size_t>(chosen.first)];
  const auto first = std::find_if(columns.begin(), columns.end(), [&](Eigen::Index c) {
    const RegressionColumn& column = regression.columns[static_cast<std::size_t>(c)];
    return column.law == chosen.first && column.shape == chosen.second;
  });
  const LawShape& shape = law.shapes[chosen.second];
  const double size = sizes(first - columns.begin());
  const double least = law.is_dissipative ? 0.0 : shape.least;
  return size >= least && size <= shape.largest && !(shape.is_leaning && std::fabs(sizes(first - columns.begin() + 1)) > size);
}

ValidatedChoice validate(const Regression& regression, const std::vector<BalanceLaw>& laws, const LawChoice& choice) {
  ValidatedChoice result;
  const std::size_t records = regression.values.size();
  result.choice = choice;
  const std::vector<Eigen::Index> columns = columns_of(regression, choice);
  result.sizes = solve(sums_of(regression, columns));
  for (const RegressionBlock& left_out : regression.blocks) {
    const Eigen::VectorXd sizes = solve(sums_of(regression, columns, [&](const RegressionBlock& block) { return &block != &left_out; }));
    const double error = squared_error(left_out, columns, sizes);
    result.block_error.push_back(error / left_out.count);
    result.of_blocks += error / regression.count;
  }
  const std::vector<Eigen::Index> told = told_by_records(regression, laws, columns);
  const RegressionSums of_all = sums_of(regression, told);
  const double determined = least_determined(of_all);
  for (std::size_t r = 0; r < records && records > 1; ++r) {
    const auto is_other = [&](const RegressionBlock& block) { return block.record != r; };
    if (least_share(sums_of(regression, told, is_other), of_all) < kLeastDetermined) {
      result.record_error.clear();
      result.record_block_error.clear();
      break;
    }
    const Eigen::VectorXd sizes = solve(sums_of(regression, columns, is_other));
    double error = 0.0, count = 0.0;
    for (const RegressionBlock& block : regression.blocks) {
      if (block.record != r) continue;
      const double of_block = squared_error(block, columns, sizes);
      result.record_block_error.push_back(of_block / block.count);
      error += of_block;
      count += block.count;
    }
    result.record_error.push_back(count > 0.0 ? error / count : 0.0);
    result.of_records += error / regression.count;
  }
  const bool is_noise = std::any_of(columns.begin(), columns.end(), [&](Eigen::Index c) { return regression.columns[static_cast<std::size_t>(c)].is_noise; });
  result.is_physical = !is_noise && result.sizes(0) > 0.0 && (choice.laws.empty() || determined > kParallel);
  for (const auto& law : choice.laws) result.is_physical = result.is_physical && has_possible_sizes(regression, laws, columns, law, result.sizes);
  return result;
}

std::pair<double, double> compared(const ValidatedChoice& a, const ValidatedChoice& b) {
  if (a.record_error.empty() || b.record_error.empty()) return {a.of_blocks, b.of_blocks};
  return {std::sqrt(a.of_blocks * a.of_records), std::sqrt(b.of_blocks * b.of_records)};
}

bool is_better(const ValidatedChoice& a, const ValidatedChoice& b) {
  const auto [left_a, left_b] = compared(a, b);
  return left_a < left_b;
}

bool helps(const ValidatedChoice& without, const ValidatedChoice& with, double gap) {
  const auto [left_with, left_without] = compared(with, without);
  if (!with.is_physical || left_with > left_without - kLeastShare * gap) return false;
  const auto count = static_cast<double>(with.block_error.size());
  double mean = 0.0, square = 0.0;
  for (std::size_t b = 0; b < with.block_error.size(); ++b) {
    const double fall = without.block_error[b] - with.block_error[b];
    mean += fall / count;
    square += fall * fall / count;
  }
  const double error = std::sqrt(std::max(0.0, square - mean * mean) / std::max(1.0, count - 1.0));
  if (mean < kSignificance * error) return false;
  double gain = 0.0, loss = 0.0;
  const std::size_t records = std::min(with.record_error.size(), without.record_error.size());
  for (std::size_t r = 0; r < records; ++r) {
    const double fall = without.record_error[r] - with.record_error[r];
    (fall > 0.0 ? gain : loss) += std::fabs(fall);
  }
  return records == 0 || gain > kSignificance * loss;
}

}  // namespace slewlab::diagnosis
