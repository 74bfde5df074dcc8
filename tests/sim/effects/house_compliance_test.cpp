#include "sim/effects/house_compliance.h"

#include <gtest/gtest.h>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// All gears push through one spring: T / k + 2 T / k_h; against each other they do not feel it.
TEST(HouseCompliance, ShowsInTheCommonTorqueOnly) {
  const CraneParameters crane = fixed_house();
  const double torque = 100.0 * torque_factor(crane);
  const double wound = torque / group_gear_stiffness(crane);
  const auto together = run(crane, "house_compliance", {1e10}, 10.0, constant_drive(100.0, 100.0));
  EXPECT_NEAR(together.back().deflection[0], group_half_play(crane) + wound + 2.0 * torque / 1e10,
              1e-8 * wound);
  const auto apart = run(crane, "house_compliance", {1e10}, 10.0, constant_drive(100.0, -100.0));
  EXPECT_NEAR(apart.back().deflection[0], group_half_play(crane) + wound, 1e-8 * wound);
}

}  // namespace
}  // namespace slewlab::sim
