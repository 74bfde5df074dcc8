#include <gtest/gtest.h>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

TEST(UnevenPlay, SplitsTheDifferenceBetweenTheHalves) {
  const CraneParameters crane = fixed_house();
  const auto samples = run(crane, "uneven_play", {4e-4}, 6.0, constant_drive(100.0, 100.0));
  const double wound = 100.0 * torque_factor(crane) / group_gear_stiffness(crane);
  EXPECT_NEAR(samples.back().deflection[0], group_half_play(crane) + 1e-4 + wound, 1e-9 * wound);
  EXPECT_NEAR(samples.back().deflection[1], group_half_play(crane) - 1e-4 + wound, 1e-9 * wound);
}

TEST(UnevenPlay, NeverGoesBelowNone) {
  CraneParameters crane = fixed_house();
  crane.drive.gearbox_play = crane.drive.pinion_play = 0.0;
  const auto samples = run(crane, "uneven_play", {4e-4}, 6.0, constant_drive(100.0, 100.0));
  const double wound = 100.0 * torque_factor(crane) / group_gear_stiffness(crane);
  EXPECT_NEAR(samples.back().deflection[1], wound, 1e-9 * wound);
}

}  // namespace
}  // namespace slewlab::sim
