#include "sim/effects/torque_ripple.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// Motors too heavy to notice turn at a steady speed: the mean of a sin over each step is known.
TEST(TorqueRipple, IsTheMeanSineOverTheTurnedAngle) {
  CraneParameters crane = rigid_crane();
  crane.drive.motor_inertia = 1e9;
  constexpr double kAmplitude = 20.0, kOrder = 6.0, kPhase = 0.7, kSpeed = 0.02, kStep = 0.001;
  const auto samples = run(crane, "torque_ripple", {kAmplitude, kOrder, kPhase}, 0.5,
                           constant_drive(10.0, 10.0), {.slew_speed = kSpeed});
  const double rate = kOrder * kSpeed * torque_factor(crane) / crane.drive.motors_per_group;
  for (const BenchSample& sample : samples) {
    const double to = rate * sample.time + kPhase, from = to - rate * kStep;
    const double mean = (std::cos(from) - std::cos(to)) / (to - from);
    EXPECT_NEAR(sample.applied_torque[0], 10.0 + kAmplitude * mean, 1e-4);
  }
}

}  // namespace
}  // namespace slewlab::sim
