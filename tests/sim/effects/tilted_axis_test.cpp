#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// About its lowest place the axis swings as a physical pendulum: 2 pi sqrt(J / T_g), longer by 1 + a^2 / 16 of its amplitude a.
TEST(TiltedAxis, SwingsAboutItsLowestPlace) {
  const CraneParameters crane = rigid_crane_without_play();
  constexpr double kTorque = 2e6, kSpeed = 0.02;
  const double frequency = std::sqrt(kTorque / whole_inertia(crane)), amplitude = kSpeed / frequency;
  const auto samples = run(crane, "tilted_axis", {kTorque, 0.0}, 130.0, no_drive, {.slew_speed = kSpeed});
  const double period = period_of(samples, [](const BenchSample& sample) { return sample.house_angle; });
  EXPECT_NEAR(period, 2.0 * std::numbers::pi / frequency * (1.0 + amplitude * amplitude / 16.0), 1e-4 * period);
}

// A quarter turn from there it falls with T_g / J.
TEST(TiltedAxis, FallsTowardsIt) {
  const CraneParameters crane = rigid_crane_without_play();
  for (const double side : {1.0, -1.0}) {
    const auto samples = run(crane, "tilted_axis", {1e5, side * 0.5 * std::numbers::pi}, 4.0);
    const double expected = side * 1e5 / whole_inertia(crane);
    EXPECT_NEAR((samples[3999].house_speed - samples[1999].house_speed) / 2.0, expected, 1e-3 * std::fabs(expected));
  }
}

}  // namespace
}  // namespace slewlab::sim
