#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// Load and crane swing against each other while the motors are free: w^2 = g / L (1 + M r^2 / J).
TEST(LoadMass, RaisesTheSwingFrequencyOfAFreeCrane) {
  CraneParameters crane = rigid_crane_with_load();
  crane.drive.gearbox_play = 10.0;
  const auto samples = run(crane, "load_mass", {1.5}, 60.0, no_drive, {.rope_angle = 0.02});
  const double radius = crane.boom.pivot_radius + crane.boom.length * std::cos(crane.boom.angle);
  const double square = 9.81 / 60.0 * (1.0 + 45e3 * radius * radius / house_and_boom_inertia(crane));
  const double period = period_of(samples, [](const BenchSample& s) { return s.rope_angle; });
  EXPECT_NEAR(period, 2.0 * std::numbers::pi / std::sqrt(square), 1e-3 * period);
}

}  // namespace
}  // namespace slewlab::sim
