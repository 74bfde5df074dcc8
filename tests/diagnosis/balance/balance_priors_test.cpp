// What the priors hold where the records say nothing, and that they say nothing where the records do.
#include "diagnosis/balance/balance_priors.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/diagnosis/balance/prepared_axis.h"

namespace slewlab::diagnosis {
namespace {

double fitted_inertia(const PreparedAxis& axis) {
  return solve(sums_of(axis.regression, columns_of(axis.regression, choice_of(axis.balance.laws, {"dry", "viscous"}))))(0);
}

// The file says 3 kg m^2, the axis has 2: records in which it changes its speed tell.
TEST(BalancePriors, RecordsThatTellTheInertiaOverruleTheFile) {
  EXPECT_NEAR(fitted_inertia(prepared_axis({.resistance = usual_friction, .noise = 2e-6}, 3.0)), 2.0, 0.03);
}

// Steady speeds for minutes: the acceleration is noise.
TEST(BalancePriors, SteadySpeedsLeaveTheInertiaOfTheFile) {
  SimulatedAxis axis{.resistance = [](double, double, double speed) { return 4.0 * speed; }, .duration = 120.0, .noise = 1e-3};
  axis.effort = [](double time) { return time < 60.0 ? 5.0 : 8.0; };
  const std::vector<BalanceRecord> records{make_balance_record(record_of(axis), 20)};
  const std::vector<BalanceLaw> laws = balance_laws({3.0, 6e-3, 120.0, 0.0, 1.0, true, {}});
  const Regression regression = prepared_regression(records, laws, 3.0, 6e-3);
  const std::vector<Eigen::Index> columns = columns_of(regression, choice_of(laws, {"viscous"}));
  Regression without = regression;
  without.ridge(0) = 0.0;
  EXPECT_LT(std::fabs(solve(sums_of(regression, columns))(0) - 3.0), std::fabs(solve(sums_of(without, columns))(0) - 3.0));
}

// Only the inertia, the skew and viscous friction's difference of the directions have one.
TEST(BalancePriors, NoLawsSizeIsDrawnToZero) {
  const PreparedAxis axis = prepared_axis({.resistance = usual_friction, .noise = 2e-6});
  const int viscous = chosen_law(axis.balance.laws, "viscous")->first;
  int priors = 0;
  for (std::size_t c = 0; c < axis.regression.columns.size(); ++c) {
    const RegressionColumn& column = axis.regression.columns[c];
    const bool has_prior = axis.regression.ridge(static_cast<Eigen::Index>(c)) > 0.0;
    priors += has_prior;
    if (has_prior) {
      EXPECT_TRUE(column.law == kAcceleration || column.law == kSkew || column.law == viscous) << column.law;
    }
  }
  EXPECT_EQ(priors, 3);
}

// One standard deviation of the inertia's prior is half of it: the ridge is noise over its square, in any units.
TEST(BalancePriors, AreInTheAxissUnits) {
  const PreparedAxis axis = prepared_axis({.resistance = usual_friction, .noise = 2e-5});
  std::vector<BalanceRecord> scaled = axis.records;
  for (BalanceRecord& record : scaled) {
    for (double& effort : record.effort) effort *= 1e3;
    for (double& rate : record.motion.effort_rate) rate *= 1e3;
    for (double& late : record.motion.late) late *= 1e3;
  }
  const Regression other = prepared_regression(scaled, axis.balance.laws, 2e3, axis.balance.resolved_speed);
  EXPECT_NEAR(other.ridge(0), axis.regression.ridge(0), 1e-6 * axis.regression.ridge(0));
}

}  // namespace
}  // namespace slewlab::diagnosis
