#include "sim/effects/wind.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// 1/2 rho v^2 C A at the boom's middle radius turns a rigid crane; on the load it is a steady rope angle.
TEST(Wind, TurnsTheBoom) {
  const CraneParameters crane = rigid_crane();
  const auto samples = run(crane, "wind", {20.0, 0.6, 80.0, 20.0}, 0.05);
  const double centre = crane.boom.pivot_radius + 0.5 * crane.boom.length * std::cos(crane.boom.angle);
  const double expected = 0.5 * 1.225 * 400.0 * 80.0 * std::sin(0.6) * centre / house_and_boom_inertia(crane);
  EXPECT_NEAR(samples.back().house_speed / 0.05, expected, 1e-4 * expected);
}

TEST(Wind, HoldsTheLoadAside) {
  const auto samples = run(pendulum(), "wind", {20.0, 0.6, 80.0, 20.0}, 5.0);
  EXPECT_NEAR(samples.back().rope_angle, 0.5 * 1.225 * 400.0 * 20.0 * std::sin(0.6) / (30e3 * 9.81), 1e-9);
  EXPECT_NEAR(samples.back().load_velocity, 0.0, 1e-9);
}

}  // namespace
}  // namespace slewlab::sim
