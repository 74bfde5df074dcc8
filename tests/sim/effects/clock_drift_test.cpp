#include <gtest/gtest.h>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

TEST(ClockDrift, SensorsFallBehindTheDrives) {
  const CraneParameters crane = rigid_crane();
  const auto samples = run(crane, "clock_drift", {0.002}, 10.0, no_drive, {.slew_speed = 0.01});
  for (std::size_t k = 999; k < samples.size(); k += 1000) {
    const double t = samples[k].time;
    EXPECT_NEAR(samples[k].readings.slew_angle, 0.01 * (t - 0.002 * t), 1e-9);
  }
  const double shaft = 0.01 * torque_factor(crane) / crane.drive.motors_per_group;
  EXPECT_NEAR(samples.back().readings.shaft_position[0], 10.0 * shaft, 1e-6) << "the drives' clock is right";
}

}  // namespace
}  // namespace slewlab::sim
