#include "diagnosis/balance/balance_unknown.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace slewlab::diagnosis {

namespace {

constexpr int kBumps = 20;            // of a smooth function of one variable
constexpr double kSmoothness = 1e-6;  // ridge, as a share of the columns' own square

// Bumps over the range of one variable, as functions of it.
Eigen::MatrixXd bumps(const Eigen::VectorXd& variable, double low, double high) {
  Eigen::MatrixXd values(variable.size(), kBumps);
  const double width = (high - low) / (kBumps - 1);
  for (Eigen::Index n = 0; n < variable.size(); ++n) {
    for (int b = 0; b < kBumps; ++b) {
      const double x = (variable(n) - (low + width * b)) / width;
      values(n, b) = std::exp(-0.5 * x * x);
    }
  }
  return values;
}

// What smooth functions of some variables leave of some targets.
LeftOutError smooth_validation(const Regression& regression, const std::vector<std::vector<Eigen::VectorXd>>& variables,
                         const std::vector<Eigen::VectorXd>& targets, bool with_acceleration) {
  const std::size_t kinds = variables.size();
  std::vector<Eigen::MatrixXd> values;
  for (std::size_t r = 0; r < targets.size(); ++r) {
    Eigen::MatrixXd all(targets[r].size(), static_cast<Eigen::Index>(kinds) * kBumps + (with_acceleration ? 1 : 0));
    for (std::size_t k = 0; k < kinds; ++k) {
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (const Eigen::VectorXd& one : variables[k]) {
        if (one.size() == 0) continue;
        low = std::min(low, one.minCoeff());
        high = std::max(high, one.maxCoeff());
      }
      all.middleCols(static_cast<Eigen::Index>(k) * kBumps, kBumps) = bumps(variables[k][r], low, high);
    }
    if (with_acceleration) all.rightCols(1) = regression.values[r].leftCols(1);
    values.push_back(std::move(all));
  }
  const Eigen::Index size = values.front().cols();
  struct Part {
    Eigen::MatrixXd products;
    Eigen::VectorXd with;
    double square, count;
    std::size_t record;
  };
  std::vector<Part> parts;
  Part sum{Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size), 0.0, 0.0, 0};
  for (std::size_t r = 0; r < targets.size(); ++r) {
    for (int b = 0; b < kBlocksPerRecord; ++b) {
      Part part{Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size), 0.0, 0.0, r};
      for (const auto& [first, count] : stretches_of(b, values[r].rows())) {
        const auto rows = values[r].middleRows(first, count);
        const auto target = targets[r].segment(first, count);
        part.products += rows.transpose() * rows;
        part.with += rows.transpose() * target;
        part.square += target.squaredNorm();
        part.count += static_cast<double>(count);
      }
      if (part.count == 0.0) continue;
      parts.push_back(std::move(part));
      sum.products += parts.back().products;
      sum.with += parts.back().with;
    }
  }
  // Of one part, from all that are fitted.
  const auto error_of = [](const Part& part, Eigen::MatrixXd products, const Eigen::VectorXd& with) {
    const Eigen::VectorXd scale = products.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt();
    products = scale.cwiseInverse().asDiagonal() * products * scale.cwiseInverse().asDiagonal();
    products.diagonal().array() += kSmoothness;
    const Eigen::VectorXd fit = scale.cwiseInverse().asDiagonal() * products.ldlt().solve(scale.cwiseInverse().asDiagonal() * with);
    return std::max(0.0, part.square - 2.0 * fit.dot(part.with) + fit.dot(part.products * fit)) / part.count;
  };
  LeftOutError left;
  for (const Part& part : parts) {
    left.block_error.push_back(error_of(part, sum.products - part.products, sum.with - part.with));
    if (targets.size() < 2) continue;
    Eigen::MatrixXd products = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd with = Eigen::VectorXd::Zero(size);
    for (const Part& other : parts) {
      if (other.record == part.record) continue;
      products += other.products;
      with += other.with;
    }
    left.record_block_error.push_back(error_of(part, std::move(products), with));
  }
  return left;
}

std::vector<Eigen::VectorXd> variable_of(const std::vector<BalanceRecord>& records, const Regression& regression,
                                         std::vector<double> BalanceRecord::* series) {
  std::vector<Eigen::VectorXd> values;
  for (std::size_t r = 0; r < records.size(); ++r) {
    Eigen::VectorXd one(static_cast<Eigen::Index>(regression.judged[r].size()));
    for (std::size_t i = 0; i < regression.judged[r].size(); ++i) one(static_cast<Eigen::Index>(i)) = (records[r].*series)[regression.judged[r][i]];
    values.push_back(std::move(one));
  }
  return values;
}

// Over all samples, of what the blocks have each.
double mean_over(const Regression& regression, const std::vector<double>& block_error) {
  double sum = 0.0;
  for (std::size_t b = 0; b < block_error.size(); ++b) sum += block_error[b] * regression.blocks[b].count;
  return sum / regression.count;
}

}  // namespace

LeftOutError unknown_validation(const std::vector<BalanceRecord>& records, const Regression& regression) {
  return smooth_validation(
      regression, {variable_of(records, regression, &BalanceRecord::speed), variable_of(records, regression, &BalanceRecord::position)}, regression.efforts, true);
}

Remainder find_remainder(const std::vector<BalanceRecord>& records, const Regression& regression, const ValidatedChoice& best) {
  std::vector<Eigen::VectorXd> residuals;
  double square = 0.0;
  for (std::size_t r = 0; r < records.size(); ++r) {
    residuals.push_back(residual_of(regression, best, r));
    square += residuals.back().squaredNorm();
  }
  const double mean = square / regression.count;
  Remainder remainder;
  const std::pair<const char*, std::vector<double> BalanceRecord::*> kVariables[] = {
      {"speed", &BalanceRecord::speed}, {"position", &BalanceRecord::position}, {"time", &BalanceRecord::time}, {"torque", &BalanceRecord::effort}};
  for (const auto& [name, series] : kVariables) {
    const double left = mean_over(regression, smooth_validation(regression, {variable_of(records, regression, series)}, residuals, false).block_error);
    const double share = mean > 0.0 ? 1.0 - left / mean : 0.0;
    if (share > remainder.share) remainder = {name, share};
  }
  constexpr double kWorthAWord = 0.1;  // of what is left
  return remainder.share > kWorthAWord ? remainder : Remainder{};
}

}  // namespace slewlab::diagnosis
