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

// What the residual of dry and viscous friction follows, of two records whose axes may differ.
std::string followed(const SimulatedAxis& first, const SimulatedAxis& second, double motor_angle = 0.0) {
  const std::vector<AxisRecord> records{two_records(first).front(), two_records(second).back()};
  const Balance balance = balance_of(records, 2.0, 8.0, true);
  const std::vector<BalanceRecord> smooth = smoothed(records, balance);
  const Regression regression = prepared_regression(smooth, balance.laws, 2.0, balance.resolved_speed);
  return find_remainder(smooth, regression, validate(regression, balance.laws, choice_of(balance.laws, {"dry", "viscous"})), motor_angle).variable;
}

TEST(BalanceUnknown, TellsWhatTheMeasuredTorqueAloneDoesNot) {
  const auto with = [](const std::function<double(double, double, double)>& more) {
    return SimulatedAxis{.resistance = [more](double t, double q, double v) { return usual_friction(t, q, v) + more(t, q, v); }, .noise = 2e-6};
  };
  const SimulatedAxis usual = with([](double, double, double) { return 0.0; });
  const auto both = [&](const std::function<double(double, double, double)>& more, double motor_angle = 0.0) { return followed(with(more), with(more), motor_angle); };
  EXPECT_EQ(both([](double, double q, double v) { return 1.5 * std::exp(-std::pow((q - 1.0) / 0.5, 2)) * std::tanh(v / 1e-3); }), "position and direction");
  EXPECT_EQ(both([](double t, double, double v) { return 0.6 * std::sin(0.5 * t) * std::tanh(v / 1e-3); }), "time and direction");
  EXPECT_EQ(both([](double, double q, double) { return 0.5 * std::sin(3.0 * 4.0 * q); }, 4.0), "angle of the motor");  // three waves a turn of four per unit
  SimulatedAxis heavier = usual, pushed = with([](double, double, double) { return 0.8; }), cold = with([](double, double, double v) { return 0.8 * std::tanh(v / 1e-3); });
  heavier.inertia *= 1.3;
  EXPECT_EQ(followed(usual, heavier), "record, as an inertia");
  EXPECT_EQ(followed(usual, pushed), "record, as a constant torque");
  EXPECT_EQ(followed(usual, cold), "record, as a friction");
}

// Losses of a gear: friction that grows with the torque that passes it, a fifth of it here. Torques are those of the records' own commands.
TEST(BalanceUnknown, TellsFrictionThatGrowsWithTheTorque) {
  constexpr double kLoss = 0.2;
  const auto first = [](double time) { return 6.0 * std::sin(1.1 * time) + 4.0 * std::sin(2.7 * time + 1.0); };
  const auto second = [](double time) { return 5.0 * std::sin(1.6 * time + 0.4) + 4.0 * std::sin(0.9 * time); };
  const auto lossy = [](const std::function<double(double)>& torque) {
    return SimulatedAxis{.resistance = [torque](double t, double q, double v) { return usual_friction(t, q, v) + kLoss * std::fabs(torque(t)) * std::tanh(v / 1e-3); }, .noise = 2e-6};
  };
  EXPECT_EQ(followed(lossy(first), lossy(second)), "torque and direction");
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
