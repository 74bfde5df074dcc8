#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

double applied(double knee, double torque) {
  return run(fixed_house(), "torque_limit", {150.0, knee}, 0.002, constant_drive(torque, 0.0)).back().applied_torque[0];
}

TEST(TorqueLimit, CutsOnBothSidesAndLeavesTheRest) {
  EXPECT_EQ(applied(0.0, 400.0), 150.0);
  EXPECT_EQ(applied(0.0, -200.0), -150.0);
  EXPECT_EQ(applied(0.0, 149.0), 149.0);
}

// Knee of 0.4: untouched up to 90 Nm, then 90 + 60 tanh((T - 90) / 60), never beyond 150.
TEST(TorqueLimit, YieldsOverItsKnee) {
  EXPECT_EQ(applied(0.4, 89.9), 89.9);
  EXPECT_EQ(applied(0.4, -89.9), -89.9);
  EXPECT_NEAR(applied(0.4, 150.0), 90.0 + 60.0 * std::tanh(1.0), 1e-12);
  EXPECT_NEAR(applied(0.4, -150.0), -90.0 - 60.0 * std::tanh(1.0), 1e-12);
  EXPECT_NEAR(applied(0.4, 1e4), 150.0, 1e-12);
  // Slope 1 on both sides of the knee's start: tanh x = x - x^3 / 3.
  EXPECT_NEAR(applied(0.4, 90.06) - applied(0.4, 89.94), 0.12, 60.0 * 1e-9);
  // A knee of nothing is the hard limit.
  EXPECT_NEAR(applied(1e-9, 149.9), 149.9, 1e-6);
  EXPECT_NEAR(applied(1e-9, 160.0), 150.0, 1e-6);
}

}  // namespace
}  // namespace slewlab::sim
