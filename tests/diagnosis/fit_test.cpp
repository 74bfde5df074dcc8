#include "diagnosis/fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/diagnosis/admitted.h"
#include "tests/diagnosis/simulated_log.h"

namespace slewlab::diagnosis {
namespace {

// Limits of L(c) = nu ln(1 + c / nu): c where it is small, ratios count where it is large, and no discount below 0.
TEST(Discount, HasItsLimits) {
  EXPECT_NEAR(discounted(0.01, 100.0), 0.01, 1e-6);
  EXPECT_EQ(discounted(-50.0, 100.0), -50.0);
  EXPECT_NEAR(discounted(2e9, 100.0) - discounted(1e9, 100.0), 100.0 * std::log(2.0), 1e-4);
}

TEST(Discount, WeightIsItsSlope) {
  for (const double c : {-3.0, 1.0, 80.0, 5000.0}) {
    const double h = 1e-4 * std::fabs(c);
    EXPECT_NEAR(discounted_weight(c, 100.0), (discounted(c + h, 100.0) - discounted(c - h, 100.0)) / (2.0 * h), 1e-6) << c;
  }
}

TEST(ResidualPower, IsWhatStandsAboveTheNoise) {
  FitSettings settings;
  settings.independent_share = 0.5;
  EXPECT_NEAR(residual_power(Eigen::VectorXd::Constant(10, 2.0), settings), 0.5 * (40.0 - 10.0), 1e-12);
}

// One nuisance (the first) moves one difference; the fit stands at z = 3, far beyond the bound at 2, where the residual is 0.
class Relaxation : public testing::Test {
 protected:
  // 100 ln(1 + c / usual).
  static MisfitCost misfit_cost(double usual) {
    EvidenceSettings settings;
    settings.law_freedom = 100.0;
    settings.law_share = 1.0;
    settings.near_freedom = 0.0;
    return {settings, usual - 100.0};
  }
  Relaxation() {
    problem_.nuisances.parameters.resize(16);  // with bounds, and the latency behind them
    result_.point.nuisance.assign(17, 0.0);
    result_.point.nuisance[0] = 3.0;
    result_.difference = Eigen::VectorXd::Zero(40);
    result_.columns = Eigen::MatrixXd::Zero(40, 17);
    result_.columns(0, 0) = 10.0;
    result_.prior = 9.0 + 30.0;  // z^2 and beyond the bound 30 (z - 2)^2, nuisance.h
  }
  Relaxed relaxed_by(double usual) const {
    return relax(problem_, result_, {residual_power_, result_.columns.transpose() * result_.columns, result_.columns.transpose() * result_.difference}, misfit_cost(usual), 0.0);
  }
  Problem problem_;
  FitResult result_;
  double residual_power_ = 0.0;
};

// Limits: where misfits cost nothing the parameter goes back to 0, with a residual power of s (10 * 3)^2; where they cost all it stays.
TEST_F(Relaxation, TradesMisfitForLikelyValues) {
  const Relaxed discounted = relaxed_by(1e12);
  EXPECT_NEAR(discounted.prior, 0.0, 1e-6);
  EXPECT_NEAR(discounted.residual_power, problem_.settings.independent_share * 900.0, 1e-3);
  const Relaxed charged = relaxed_by(1e-3);
  EXPECT_NEAR(charged.prior, result_.prior, 0.05);
  EXPECT_NEAR(charged.residual_power, 0.0, 1e-3);
}

// A cost that does not go with where the parameters stand stays wherever they go.
TEST_F(Relaxation, KeepsWhatIsChargedBesides) {
  result_.prior += 25.0;
  EXPECT_NEAR(relaxed_by(1e12).prior, 25.0, 1e-6);
}

// The minimum of 100 ln(1 + 0.3 (10 (z - 3))^2 / 1000) + z^2 + 30 max(0, z - 2)^2, by search over z.
TEST_F(Relaxation, FindsTheLeastOfBoth) {
  double least = 1e300, prior = 0.0;
  for (int n = 0; n < 30000; ++n) {
    const double z = 1e-4 * n;
    const double p = z * z + 30.0 * std::pow(std::max(0.0, z - 2.0), 2.0);
    const double cost = 100.0 * std::log1p(0.3 * 100.0 * (z - 3.0) * (z - 3.0) / 1000.0) + p;
    if (cost >= least) continue;
    least = cost;
    prior = p;
  }
  const Relaxed relaxed = relaxed_by(1000.0);
  EXPECT_NEAR(100.0 * std::log1p(relaxed.residual_power / 1000.0) + relaxed.prior, least, 0.02);
  EXPECT_NEAR(relaxed.prior, prior, 0.3);
}

// Columns that promise less than the fit has reached are not believed: they are those of a fit that has not settled.
TEST_F(Relaxation, PromisesNothingThatWasNotReached) {
  result_.difference(0) = 30.0;
  residual_power_ = 500.0;
  EXPECT_GE(relaxed_by(1e-3).residual_power, 500.0);
}

// A fit that is to come down to a cost ends where it would not at the pace of its last round: here behind the first. Nothing is to be reached, and it settles.
TEST(Settle, EndsWhereItWouldNotComeDownToWhatIsToBeReached) {
  sim::MachineSettings truth;
  truth.crane = spread_crane(5);
  Admitted admitted({simulated_log(truth, bench().controller, kInching, kDuration, 2, 1e-2)});
  Problem& problem = admitted.problem;
  FitResult start = nominal_fit(problem);
  start.columns = Eigen::MatrixXd::Zero(start.difference.size(), static_cast<Eigen::Index>(nuisance_count(problem)));
  start.cost = 1e9;
  FitResult once = start, ended = start, settled = start;
  settle(problem, once, 1);
  settle(problem, ended, 10, -1e12);
  settle(problem, settled, 10);
  EXPECT_EQ(ended.cost, once.cost);
  EXPECT_EQ(ended.point.nuisance, once.point.nuisance);
  EXPECT_LT(settled.cost, once.cost);
  FitResult reached = start;
  settle(problem, reached, 10, settled.cost);
  EXPECT_LE(reached.cost, settled.cost);
}

}  // namespace
}  // namespace slewlab::diagnosis
