#include <gtest/gtest.h>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

TEST(HouseInertia, SlowsTheAcceleration) {
  CraneParameters crane = rigid_crane();
  crane.drive.gear_damping_ratio = 0.5;
  const auto samples = run(crane, "house_inertia", {10.0}, 6.0, constant_drive(100.0, 100.0));
  const double expected =
      2.0 * 100.0 * torque_factor(crane) / (whole_inertia(crane) + 9.0 * crane.house.inertia);
  EXPECT_NEAR((samples[5999].house_speed - samples[3999].house_speed) / 2.0, expected, 1e-5 * expected);
}

}  // namespace
}  // namespace slewlab::sim
