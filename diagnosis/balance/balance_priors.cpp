#include "diagnosis/balance/balance_priors.h"

#include <algorithm>
#include <cmath>

#include "diagnosis/balance/balance_regression.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kInertiaPrior = 0.5;  // of the file's inertia, one standard deviation: 20 to 50 % off is an ordinary machine; chosen
constexpr double kSkewPrior = 0.5;     // [samples]: a torque is held, or read at once, or the mean since the last sample; chosen
constexpr double kMostSkews = 3.0;     // standard deviations of that, beyond which it is a law's
constexpr double kDriveLag = 0.005;    // of the time in which the axis changes its speed, that a drive's current control takes; chosen
constexpr double kLean = 0.3;          // of viscous friction, half the difference of its directions; chosen

void add_priors(const std::vector<BalanceRecord>& records, const std::vector<BalanceLaw>& laws, Regression& regression) {
  double speed = 0.0, acceleration = 0.0, rate = 0.0, step = 0.0;
  for (std::size_t r = 0; r < records.size(); ++r) {
    for (const std::size_t n : regression.judged[r]) {
      speed += records[r].speed[n] * records[r].speed[n];
      acceleration += records[r].acceleration[n] * records[r].acceleration[n];
    }
    rate += regression.values[r].col(1).squaredNorm();
    step = std::max(step, records[r].step);
  }
  regression.is_skewed = rate > 0.0;
  LawChoice ordinary;
  for (std::size_t l = 0; l < laws.size(); ++l) {
    if (laws[l].is_ordinary) ordinary.laws.emplace_back(static_cast<int>(l), 0);
  }
  const std::vector<Eigen::Index> columns = columns_of(regression, ordinary);
  FittedChoice base;
  base.choice = ordinary;
  base.sizes = solve(sums_of(regression, columns));
  double square = 0.0;
  for (const RegressionBlock& block : regression.blocks) square += std::max(0.0, squared_error(block, columns, base.sizes));
  const double noise = square / regression.count * correlation_length(regression, base);
  const double inertia_deviation = kInertiaPrior * regression.nominal_inertia;
  regression.ridge(0) = inertia_deviation > 0.0 ? noise / (inertia_deviation * inertia_deviation) : 0.0;
  if (regression.is_skewed) {
    const double prior = std::hypot(kSkewPrior * step, acceleration > 0.0 ? kDriveLag * std::sqrt(speed / acceleration) : 0.0);
    regression.ridge(kSkewColumn) = noise / (prior * prior);
    // Further apart than a few of that is no recorder's doing, and a law's to explain.
    constexpr double kTighter = 2.0;
    constexpr int kRounds = 40;
    for (int round = 0; round < kRounds && std::fabs(solve(sums_of(regression, columns))(kSkewColumn)) > kMostSkews * prior; ++round) {
      regression.ridge(kSkewColumn) *= kTighter;
    }
  }
  const auto viscous = chosen_law(laws, "viscous");
  if (!viscous || !(speed > 0.0) || !laws[static_cast<std::size_t>(viscous->first)].shapes[viscous->second].is_leaning) return;
  for (std::size_t c = 0; c < regression.columns.size(); ++c) {
    if (regression.columns[c].law != viscous->first) continue;
    const auto at = std::find(columns.begin(), columns.end(), static_cast<Eigen::Index>(c)) - columns.begin();
    const double size = std::max(base.sizes(at), std::sqrt(square / speed));  // at least what would hide in the residual
    regression.ridge(static_cast<Eigen::Index>(c) + 1) = noise / (kLean * kLean * size * size);
    break;
  }
}

}  // namespace

Regression prepared_regression(const std::vector<BalanceRecord>& records, const std::vector<BalanceLaw>& laws, double nominal_inertia, double resolved_speed) {
  Regression regression = make_regression(records, laws, resolved_speed);
  regression.nominal_inertia = nominal_inertia;
  add_priors(records, laws, regression);
  return regression;
}

}  // namespace slewlab::diagnosis
