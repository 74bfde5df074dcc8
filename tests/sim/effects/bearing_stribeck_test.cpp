#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// Torque brought up slowly: nothing moves below the breakaway torque, and the crane moves above it.
TEST(BearingStribeck, HoldsUpToTheBreakawayTorque) {
  const CraneParameters crane = rigid_crane_without_play();
  const double breakaway = 3e5 / (2.0 * torque_factor(crane));  // [Nm] per motor
  for (const double share : {0.95, 1.05}) {
    const auto samples = run(crane, "bearing_stribeck", {1.5e5, 1.5e5, 0.005, 0.0, 0.0}, 14.0, [&](double time) {
      const double torque = share * breakaway * std::min(1.0, time / 10.0);
      return constant_drive(torque, torque)(time);
    });
    if (share < 1.0) {
      // It stands at every step's end; within a step the rising torque moves it by less than h^3.
      EXPECT_NEAR(samples.back().house_angle, 0.0, 1e-7);
    } else {
      EXPECT_GT(samples.back().house_angle, 1e-3);
    }
  }
}

// Far above the Stribeck speed only the Coulomb torque is left.
TEST(BearingStribeck, IsCoulombAtSpeed) {
  const CraneParameters crane = rigid_crane_without_play();
  const auto samples =
      run(crane, "bearing_stribeck", {1.5e5, 1.5e5, 0.002, 0.0, 0.0}, 4.0, no_drive, {.slew_speed = 0.05});
  const double expected = 1.5e5 / whole_inertia(crane);
  EXPECT_NEAR((samples[1499].house_speed - samples[3499].house_speed) / 2.0, expected, 1e-3 * expected);
}

// The fall itself: slowed by friction alone, d(omega)/dt = -(T_c + T_s exp(-(omega / omega_s)^2)) / J at every speed on the way down;
// the quotient over 20 ms against the law at its middle.
TEST(BearingStribeck, FallsAsTheCurveSays) {
  const CraneParameters crane = rigid_crane_without_play();
  constexpr double kCoulomb = 1.5e5, kExcess = 3e5, kStribeckSpeed = 0.01;
  const auto samples = run(crane, "bearing_stribeck", {kCoulomb, kExcess, kStribeckSpeed, 0.0, 0.0}, 15.0, no_drive, {.slew_speed = 0.025});
  for (const double share : {2.0, 1.0, 0.5}) {
    const auto passes = std::find_if(samples.begin(), samples.end(), [&](const auto& sample) { return sample.house_speed < share * kStribeckSpeed; });
    ASSERT_NE(passes, samples.end());
    const double slope = ((passes + 10)->house_speed - (passes - 10)->house_speed) / ((passes + 10)->time - (passes - 10)->time);
    const double expected = -(kCoulomb + kExcess * std::exp(-share * share)) / whole_inertia(crane);
    EXPECT_NEAR(slope, expected, 0.02 * std::fabs(expected)) << share;
  }
}

// Without excess it is bearing_coulomb, to the bit.
TEST(BearingStribeck, WithoutExcessIsCoulomb) {
  const CraneParameters crane = rigid_crane_without_play();
  for (const double give : {0.0, 5e-5}) {
    const auto stribeck =
        run(crane, "bearing_stribeck", {2e5, 0.0, 0.005, 0.2, give}, 2.0, no_drive, {.slew_speed = 0.01});
    const auto coulomb = run(crane, "bearing_coulomb", {2e5, 0.2, give}, 2.0, no_drive, {.slew_speed = 0.01});
    EXPECT_EQ(stribeck.back().house_angle, coulomb.back().house_angle);
  }
}

}  // namespace
}  // namespace slewlab::sim
