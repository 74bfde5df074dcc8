#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// Motors free in a wide play: angle = T t^2 / (2 J), by a torque that is the command times (1 + m) (1 +- s).
TEST(UnevenMotorTorque, GroupsAccelerateByTheirOwnTorque) {
  CraneParameters crane = rigid_crane();
  crane.drive.gearbox_play = 10.0;
  const auto samples = run(crane, "uneven_motor_torque", {0.1, 0.05}, 1.0, constant_drive(50.0, -30.0));
  const double group = (whole_inertia(crane) - house_and_boom_inertia(crane)) / 2.0;
  const double angle = 0.5 * torque_factor(crane) / group;  // [rad/(N m)]
  EXPECT_NEAR(samples.back().motor_angle[0], angle * 50.0 * 1.05 * 1.1, 1e-9);
  EXPECT_NEAR(samples.back().motor_angle[1], angle * -30.0 * 1.05 * 0.9, 1e-9);
  EXPECT_NEAR(samples.back().applied_torque[0], 50.0 * 1.05 * 1.1, 1e-12);
}

TEST(UnevenMotorTorque, OneGroupHasNoDifference) {
  CraneParameters crane = rigid_crane();
  crane.drive.group_count = 1;
  EXPECT_THROW(run(crane, "uneven_motor_torque", {0.2, 0.0}, 0.5, constant_drive(50.0, 0.0)), std::invalid_argument);
}

}  // namespace
}  // namespace slewlab::sim
