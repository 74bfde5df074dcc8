#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// The load hangs along gravity, and an accelerometer at rest reads gravity's part.
TEST(Heel, LoadHangsAlongGravity) {
  constexpr double kAngle = 0.02;
  const auto samples = run(pendulum(), "heel", {kAngle, std::numbers::pi / 2.0}, 5.0);
  EXPECT_NEAR(samples.back().rope_angle, std::sin(kAngle), 1e-9);
  EXPECT_NEAR(samples.back().load_velocity, 0.0, 1e-9);
  EXPECT_NEAR(samples.back().readings.tip_acceleration, -9.81 * std::sin(kAngle), 1e-9);
}

// A rigid boom is pushed downhill by its weight at its centre's radius.
TEST(Heel, PushesTheBoomDownhill) {
  const CraneParameters crane = rigid_crane();
  constexpr double kAngle = 0.02, kDirection = 0.6;
  const auto samples = run(crane, "heel", {kAngle, kDirection}, 0.05);
  const double centre = crane.boom.pivot_radius + 0.5 * crane.boom.length * std::cos(crane.boom.angle);
  const double expected = crane.boom.mass * 9.81 * std::sin(kAngle) * std::sin(kDirection) * centre /
                          house_and_boom_inertia(crane);
  EXPECT_NEAR(samples.back().house_speed / 0.05, expected, 1e-4 * expected);
}

}  // namespace
}  // namespace slewlab::sim
