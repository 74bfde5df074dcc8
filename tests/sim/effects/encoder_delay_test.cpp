#include <gtest/gtest.h>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

TEST(EncoderDelay, ReadsThePast) {
  const CraneParameters crane = rigid_crane();
  const auto samples = run(crane, "encoder_delay", {0.0123}, 1.0, no_drive, {.slew_speed = 0.01});
  const double shaft = 0.01 * torque_factor(crane) / crane.drive.motors_per_group;
  EXPECT_NEAR(samples.back().readings.shaft_position[0], shaft * (1.0 - 0.0123), 1e-9);
  EXPECT_NEAR(samples.back().readings.slew_angle, 0.01, 1e-12) << "no encoder of the shafts";
}

// While it is accelerated and rings: what is read is what was read without the delay, so many steps earlier, to the bit.
TEST(EncoderDelay, ReadsThePastOfAnyMotion) {
  constexpr std::size_t kSteps = 12;  // of 1 ms
  const CraneParameters crane = rigid_crane();
  const auto late = run(crane, "encoder_delay", {1e-3 * kSteps}, 1.0, constant_drive(50.0, 20.0));
  const auto sharp = run({.crane = crane, .effects = {}, .step = 1e-3}, 1.0, constant_drive(50.0, 20.0));
  for (std::size_t n = kSteps; n < sharp.size(); ++n) {
    ASSERT_NEAR(late[n].readings.shaft_speed[0], sharp[n - kSteps].readings.shaft_speed[0], 1e-12) << n;
    ASSERT_NEAR(late[n].readings.shaft_position[1], sharp[n - kSteps].readings.shaft_position[1], 1e-12) << n;
  }
}

}  // namespace
}  // namespace slewlab::sim
