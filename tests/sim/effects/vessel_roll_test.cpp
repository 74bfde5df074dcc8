#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// A load under a tip that stands still in the rolling vessel: y'' + w^2 y = F cos(W t) from the steady hang F
// / w^2.
TEST(VesselRoll, ForcesTheSwing) {
  const CraneParameters crane = pendulum();
  constexpr double kAmplitude = 0.01, kHeight = 20.0;
  const double roll = 2.0 * std::numbers::pi / 10.0;
  const auto samples = run(crane, "vessel_roll",
                           {kAmplitude, 10.0, std::numbers::pi / 2.0, std::numbers::pi / 2.0, kHeight}, 40.0);
  const double square = 9.81 / 60.0;
  const double load_height = kHeight + crane.boom.length * std::sin(crane.boom.angle) - 60.0;
  const double force = (9.81 + load_height * roll * roll) * kAmplitude;
  const double forced = force / (square - roll * roll);
  for (std::size_t k = 999; k < samples.size(); k += 1000) {
    const double t = samples[k].time;
    const double expected =
        forced * std::cos(roll * t) + (force / square - forced) * std::cos(std::sqrt(square) * t);
    EXPECT_NEAR(samples[k].load_displacement, expected, 1e-5);
    const double pivot = (9.81 + kHeight * roll * roll) * kAmplitude * std::cos(roll * t);
    EXPECT_NEAR(samples[k].readings.pivot_acceleration, -pivot, 1e-9);
  }
}

}  // namespace
}  // namespace slewlab::sim
