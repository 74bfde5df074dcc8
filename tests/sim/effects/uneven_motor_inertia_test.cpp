#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// Motors free in a wide play: angle = T t^2 / (2 J).
TEST(UnevenMotorInertia, GroupsAccelerateByTheirOwnInertia) {
  CraneParameters crane = rigid_crane();
  crane.drive.gearbox_play = 10.0;
  const auto samples = run(crane, "uneven_motor_inertia", {0.2, 0.0}, 1.0, constant_drive(50.0, 50.0));
  const double group = (whole_inertia(crane) - house_and_boom_inertia(crane)) / 2.0;
  const double angle = 0.5 * 50.0 * torque_factor(crane) / group;
  EXPECT_NEAR(samples.back().motor_angle[0], angle / 1.2, 1e-9);
  EXPECT_NEAR(samples.back().motor_angle[1], angle / 0.8, 1e-9);
}

TEST(UnevenMotorInertia, OneGroupHasNoDifference) {
  CraneParameters crane = rigid_crane();
  crane.drive.group_count = 1;
  EXPECT_THROW(run(crane, "uneven_motor_inertia", {0.2, 0.0}, 0.5, constant_drive(50.0, 0.0)), std::invalid_argument);
}

}  // namespace
}  // namespace slewlab::sim
