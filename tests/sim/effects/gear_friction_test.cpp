#include "sim/effects/gear_friction.h"

#include <gtest/gtest.h>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// Rigid crane under constant torque T per group: T = T_g (1 + loss) + J_m a, N T_g = J a.
TEST(GearFriction, CostsItsShareOfTheGearTorque) {
  CraneParameters crane = rigid_crane();
  crane.drive.gear_damping_ratio = 0.5;
  const auto samples = run(crane, "gear_friction", {0.1}, 6.0, constant_drive(100.0, 100.0));
  const double driven = house_and_boom_inertia(crane);
  const double motors = whole_inertia(crane) - driven;
  const double expected = 2.0 * 100.0 * torque_factor(crane) / (motors + 1.1 * driven);
  const double measured = (samples[5999].house_speed - samples[3999].house_speed) / 2.0;
  EXPECT_NEAR(measured, expected, 1e-4 * expected);
}

}  // namespace
}  // namespace slewlab::sim
