#include <gtest/gtest.h>

#include <cmath>

#include "sim/model/boom.h"
#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// The drag of the relative wind, 1/2 rho C A w |w| with w the wind less the crane's own speed, of which the part across the boom
// counts. The law is that to first order in the own speed: here u / v is 0.02 or less, its square 0.0004.
double relative_pressure(double wind, double angle, double own) {
  const double across = wind * std::sin(angle) - own, along = wind * std::cos(angle);
  return 0.5 * 1.225 * across * std::hypot(across, along);
}

// At the boom's middle radius it turns a rigid crane, whose own speed rises from 0 meanwhile; on the load it is a steady rope angle.
TEST(Wind, TurnsTheBoom) {
  const CraneParameters crane = rigid_crane();
  const auto samples = run(crane, "wind", {20.0, 0.6, 80.0, 20.0}, 0.05);
  const double centre = crane.boom.pivot_radius + 0.5 * crane.boom.length * std::cos(crane.boom.angle);
  const double mean_own_speed = 0.5 * samples.back().house_speed * centre;
  const double expected = relative_pressure(20.0, 0.6, mean_own_speed) * 80.0 * centre / house_and_boom_inertia(crane);
  EXPECT_NEAR(samples.back().house_speed / 0.05, expected, 1e-4 * expected);
}

TEST(Wind, HoldsTheLoadAside) {
  const auto samples = run(pendulum(), "wind", {20.0, 0.6, 80.0, 20.0}, 5.0);
  EXPECT_NEAR(samples.back().rope_angle, 0.5 * 1.225 * 400.0 * 20.0 * std::sin(0.6) / (30e3 * 9.81), 1e-9);
  EXPECT_NEAR(samples.back().load_velocity, 0.0, 1e-9);
}

TEST(Wind, DampsATurningBoom) {
  const CraneParameters crane = rigid_crane();
  const double centre = crane.boom.pivot_radius + 0.5 * crane.boom.length * std::cos(crane.boom.angle);
  const BenchStart turning{.slew_speed = 0.4 / centre};
  const double without = run(crane, "wind", {0.0, 0.6, 80.0, 20.0}, 0.05, no_drive, turning).back().house_speed;
  const double with = run(crane, "wind", {20.0, 0.6, 80.0, 20.0}, 0.05, no_drive, turning).back().house_speed;
  const double expected = relative_pressure(20.0, 0.6, 0.4) * 80.0 * centre / house_and_boom_inertia(crane);
  EXPECT_NEAR((with - without) / 0.05, expected, 2e-3 * expected);
  EXPECT_LT(expected, 0.96 * relative_pressure(20.0, 0.6, 0.0) * 80.0 * centre / house_and_boom_inertia(crane));
}

TEST(Wind, DampsASwingingLoad) {
  const CraneParameters crane = pendulum();
  const BenchStart turning{.slew_speed = 0.4 / tip_radius(crane.boom)};
  const double without = run(crane, "wind", {0.0, 0.6, 80.0, 20.0}, 0.05, no_drive, turning).back().load_velocity;
  const double with = run(crane, "wind", {20.0, 0.6, 80.0, 20.0}, 0.05, no_drive, turning).back().load_velocity;
  // It hangs at rest in the wind before it moves; half way the house has turned a little.
  const double angle = 0.6 - 0.5 * 0.05 * turning.slew_speed;
  const double expected = (relative_pressure(20.0, angle, 0.4) - relative_pressure(20.0, 0.6, 0.0)) * 20.0 / 30e3;
  EXPECT_LT(expected, 0.0);
  EXPECT_NEAR((with - without) / 0.05, expected, -0.02 * expected);
}

}  // namespace
}  // namespace slewlab::sim
