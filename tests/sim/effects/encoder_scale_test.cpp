#include <gtest/gtest.h>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

TEST(EncoderScale, MultipliesPositionAndSpeed) {
  const CraneParameters crane = rigid_crane();
  const auto samples = run(crane, "encoder_scale", {-0.02}, 1.0, no_drive, {.slew_speed = 0.01});
  const double shaft = 0.01 * torque_factor(crane) / crane.drive.motors_per_group;
  EXPECT_NEAR(samples.back().readings.shaft_speed[1], 0.98 * shaft, 1e-9);
  EXPECT_NEAR(samples.back().readings.shaft_position[1], 0.98 * shaft, 1e-9);
  EXPECT_NEAR(samples.back().readings.slew_angle, 0.01, 1e-12) << "no encoder of the shafts";
}

}  // namespace
}  // namespace slewlab::sim
