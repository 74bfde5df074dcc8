#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// Slowed by friction alone, d(omega)/dt = -T(omega) / J at every speed on the way down; the quotient over 20 ms against the
// law at its middle, by direction.
TEST(BearingRising, RisesAsTheCurveSays) {
  const CraneParameters crane = rigid_crane_without_play();
  constexpr double kTorque = 3e5, kSpeed = 0.008, kAtRest = 0.25, kAsymmetry = 0.2;
  for (const double side : {1.0, -1.0}) {
    const auto samples = run(crane, "bearing_rising", {kTorque, kSpeed, kAtRest, kAsymmetry, 0.0}, 15.0, no_drive, {.slew_speed = side * 0.03});
    for (const double share : {3.0, 1.0, 0.3}) {
      const auto passes = std::find_if(samples.begin(), samples.end(), [&](const auto& sample) { return side * sample.house_speed < share * kSpeed; });
      ASSERT_NE(passes, samples.end());
      const double slope = ((passes + 10)->house_speed - (passes - 10)->house_speed) / ((passes + 10)->time - (passes - 10)->time);
      const double level = kTorque * (kAtRest + (1.0 - kAtRest) * (1.0 - std::exp(-share)));
      const double expected = -side * (1.0 + side * kAsymmetry) * level / whole_inertia(crane);
      EXPECT_NEAR(slope, expected, 0.02 * std::fabs(expected)) << share;
    }
  }
}

// At rest it holds its share, and no more.
TEST(BearingRising, HoldsItsShareAtRest) {
  const CraneParameters crane = rigid_crane_without_play();
  for (const double share : {0.95, 1.05}) {
    const double torque = share * 0.5 * 2e5 / (2.0 * torque_factor(crane));  // [Nm] per motor
    const auto samples = run(crane, "bearing_rising", {2e5, 0.01, 0.5, 0.0, 0.0}, 14.0, [&](double time) {
      return constant_drive(torque * std::min(1.0, time / 10.0), torque * std::min(1.0, time / 10.0))(time);
    });
    if (share < 1.0) {
      EXPECT_NEAR(samples.back().house_angle, 0.0, 1e-7);
    } else {
      EXPECT_GT(samples.back().house_angle, 1e-4);
    }
  }
}

// All of it held at rest is dry friction, to the bit.
TEST(BearingRising, WithAllOfItAtRestIsCoulomb) {
  const CraneParameters crane = rigid_crane_without_play();
  for (const double give : {0.0, 5e-5}) {
    const auto rising = run(crane, "bearing_rising", {2e5, 0.01, 1.0, 0.2, give}, 4.0, no_drive, {.slew_speed = 0.01});
    const auto coulomb = run(crane, "bearing_coulomb", {2e5, 0.2, give}, 4.0, no_drive, {.slew_speed = 0.01});
    EXPECT_EQ(rising.back().house_angle, coulomb.back().house_angle);
  }
}

}  // namespace
}  // namespace slewlab::sim
