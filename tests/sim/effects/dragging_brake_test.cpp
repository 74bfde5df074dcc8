#include <gtest/gtest.h>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// A rigid crane coasts to rest at 2 T / J and stays.
TEST(DraggingBrake, StopsACoastingCrane) {
  CraneParameters crane = rigid_crane();
  crane.drive.gear_damping_ratio = 0.5;
  crane.drive.gearbox_play = crane.drive.pinion_play = 0.0;
  const auto samples = run(crane, "dragging_brake", {20.0, 0.0, 0.0}, 12.0, no_drive, {.slew_speed = 0.02});
  const double expected = 2.0 * 20.0 * torque_factor(crane) / whole_inertia(crane);
  EXPECT_NEAR((samples[1499].motor_speed[0] - samples[3499].motor_speed[0]) / 2.0, expected, 1e-3 * expected);
  EXPECT_NEAR(samples.back().motor_speed[0], 0.0, 1e-12);
  EXPECT_EQ(samples.back().motor_angle[0], samples[11000].motor_angle[0]);
}

// Motors free in a wide play: each group by its own friction.
TEST(DraggingBrake, UnevennessSplitsItBetweenTheHalves) {
  CraneParameters crane = rigid_crane();
  crane.drive.gearbox_play = 10.0;
  const auto samples = run(crane, "dragging_brake", {20.0, 0.5, 0.0}, 0.5, no_drive, {.slew_speed = 0.02});
  const double group = (whole_inertia(crane) - house_and_boom_inertia(crane)) / 2.0;
  const double lost = 20.0 * torque_factor(crane) / group * 0.5;
  EXPECT_NEAR(samples.back().motor_speed[0], 0.02 - 1.5 * lost, 1e-12);
  EXPECT_NEAR(samples.back().motor_speed[1], 0.02 - 0.5 * lost, 1e-12);
}

}  // namespace
}  // namespace slewlab::sim
