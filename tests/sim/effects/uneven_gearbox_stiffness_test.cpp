#include <gtest/gtest.h>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// Against a house that stands still: deflection = half play + T / k.
TEST(UnevenGearboxStiffness, GearsWindUpByTheirOwnStiffness) {
  const CraneParameters crane = fixed_house();
  const auto samples = run(crane, "uneven_gearbox_stiffness", {0.2, 0.0}, 6.0, constant_drive(100.0, 100.0));
  const double wound = 100.0 * torque_factor(crane) / group_gear_stiffness(crane);
  EXPECT_NEAR(samples.back().deflection[0], group_half_play(crane) + wound / 1.2, 1e-9 * wound);
  EXPECT_NEAR(samples.back().deflection[1], group_half_play(crane) + wound / 0.8, 1e-9 * wound);
}

// One group that has lost 30 %, the others as they were are: (1 + 0.7) / 2 of the mean, and a difference of 0.3 / 1.7.
TEST(UnevenGearboxStiffness, HasADefectInOneGroup) {
  const CraneParameters crane = fixed_house();
  const auto samples = run(crane, "uneven_gearbox_stiffness", {0.3 / 1.7, -0.15}, 6.0, constant_drive(100.0, 100.0));
  const double wound = 100.0 * torque_factor(crane) / group_gear_stiffness(crane);
  EXPECT_NEAR(samples.back().deflection[0], group_half_play(crane) + wound, 1e-9 * wound);
  EXPECT_NEAR(samples.back().deflection[1], group_half_play(crane) + wound / 0.7, 1e-9 * wound);
}

}  // namespace
}  // namespace slewlab::sim
