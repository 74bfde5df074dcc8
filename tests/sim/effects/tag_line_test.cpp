#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// w^2 = g / L + k / M, decay c / (2 M).
TEST(TagLine, StiffensAndDampsTheSwing) {
  const auto samples = run(pendulum(), "tag_line", {500.0, 2000.0}, 60.0, no_drive, {.rope_angle = 0.02});
  const double decay = 2000.0 / (2.0 * 30e3);
  const double frequency = std::sqrt(9.81 / 60.0 + 500.0 / 30e3 - decay * decay);
  const double period = period_of(samples, [](const BenchSample& s) { return s.load_displacement; });
  EXPECT_NEAR(period, 2.0 * std::numbers::pi / frequency, 1e-5 * period);
  // After n whole periods the displacement is back at its start, less the decay.
  const double t = 3.0 * 2.0 * std::numbers::pi / frequency;
  const auto k = static_cast<std::size_t>(std::lround(t / 0.001)) - 1;
  EXPECT_NEAR(samples[k].load_displacement / 1.2, std::exp(-decay * t), 1e-4);
}

// Its moment turns the house, besides the rope's at the tip.
TEST(TagLine, PullsTheHouseAlong) {
  const CraneParameters crane = rigid_crane_with_load();
  const double radius = crane.boom.pivot_radius + crane.boom.length * std::cos(crane.boom.angle);
  const auto samples = run(crane, "tag_line", {500.0, 0.0}, 0.02, no_drive, {.rope_angle = 0.02});
  const double force = (30e3 * 9.81 / 60.0 + 500.0) * 1.2;
  const double expected = force * radius / house_and_boom_inertia(crane);
  EXPECT_NEAR(samples.back().house_speed / 0.02, expected, 1e-3 * expected);
}

}  // namespace
}  // namespace slewlab::sim
