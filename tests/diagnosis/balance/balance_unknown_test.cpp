// What no law of the catalogue explains, on axes that were given such a thing.
#include "diagnosis/balance/balance_unknown.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "tests/diagnosis/balance/prepared_axis.h"

namespace slewlab::diagnosis {
namespace {

// A tight spot of the ring; the viscous part holds the axis within a few radians.
double tight_spot(double, double position, double speed) { return 0.8 * speed + 3.0 * std::exp(-std::pow((position - 1.5) / 0.5, 2)); }

double mean_of(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size()); }

TEST(BalanceUnknown, TheRemainderFollowsWhatWasPutIn) {
  const PreparedAxis spot = prepared_axis({.resistance = tight_spot, .noise = 2e-6});
  const Remainder remainder = find_remainder(spot.records, spot.regression, validate(spot.regression, spot.balance.laws, choice_of(spot.balance.laws, {"viscous"})));
  EXPECT_EQ(remainder.variable, "position");
  EXPECT_GT(remainder.share, 0.5);
  EXPECT_LE(remainder.share, 1.0);
  const PreparedAxis drift = prepared_axis({.resistance = [](double t, double, double v) { return 0.8 * v + 0.5 * std::sin(0.7 * t); }, .noise = 2e-6});
  EXPECT_EQ(find_remainder(drift.records, drift.regression, validate(drift.regression, drift.balance.laws, choice_of(drift.balance.laws, {"viscous"}))).variable, "time");
}

TEST(BalanceUnknown, NoiseFollowsNothing) {
  const PreparedAxis axis = prepared_axis({.noise = 1e-4});
  EXPECT_EQ(find_remainder(axis.records, axis.regression, validate(axis.regression, axis.balance.laws, {})).variable, "");
}

// A smooth function of the position explains the spot, which no law of the catalogue does.
TEST(BalanceUnknown, ASmoothFunctionExplainsWhatNoLawDoes) {
  const PreparedAxis axis = prepared_axis({.resistance = tight_spot, .noise = 2e-6});
  const LeftOutError smooth = unknown_validation(axis.records, axis.regression);
  ASSERT_EQ(smooth.block_error.size(), axis.regression.blocks.size());
  ASSERT_EQ(smooth.record_block_error.size(), axis.regression.blocks.size());
  EXPECT_LT(mean_of(smooth.block_error), 0.1 * validate(axis.regression, axis.balance.laws, choice_of(axis.balance.laws, {"viscous"})).of_blocks);
}

}  // namespace
}  // namespace slewlab::diagnosis
