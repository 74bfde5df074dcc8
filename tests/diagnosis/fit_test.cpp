#include "diagnosis/fit.h"

#include <gtest/gtest.h>

#include <cmath>

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

TEST(Excess, IsWhatStandsAboveTheNoise) {
  FitSettings settings;
  settings.independent_share = 0.5;
  EXPECT_NEAR(excess(Eigen::VectorXd::Constant(10, 2.0), settings), 0.5 * (40.0 - 10.0), 1e-12);
}

}  // namespace
}  // namespace slewlab::diagnosis
