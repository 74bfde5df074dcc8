#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// Motors too heavy to notice turn at a steady speed: the mean of both sines over each step is known.
TEST(TorqueRipple, IsTheMeanOfItsSinesOverTheTurnedAngle) {
  CraneParameters crane = rigid_crane();
  crane.drive.motor_inertia = 1e9;
  constexpr double kAmplitude = 20.0, kOrder = 6.0, kPhase = 0.7, kLast = -1.9, kSine = 0.3, kCosine = -0.2, kShare = 0.25;
  constexpr double kSpeed = 0.02, kStep = 0.001;
  const auto samples = run(crane, "torque_ripple", {kAmplitude, kOrder, kPhase, kLast, kSine, kCosine, kShare}, 0.5,
                           constant_drive(10.0, 10.0), {.slew_speed = kSpeed});
  const double rate = kOrder * kSpeed * torque_factor(crane) / crane.drive.motors_per_group;
  for (const BenchSample& sample : samples) {
    const double to = rate * sample.time, from = to - rate * kStep;
    const double first = (std::cos(from + kPhase) - std::cos(to + kPhase)) / (to - from);
    const double sine = (std::cos(2.0 * from) - std::cos(2.0 * to)) / (2.0 * (to - from));
    const double cosine = (std::sin(2.0 * to) - std::sin(2.0 * from)) / (2.0 * (to - from));
    const double mean = first + kSine * sine + kCosine * cosine;
    EXPECT_NEAR(sample.applied_torque[0], 10.0 + (1.0 + kShare) * kAmplitude * mean, 1e-4);
    // The last half has the same wave: where the first one is when it has turned by so much more.
    const double on = kLast - kPhase, ends = to + on, begins = from + on;
    const double of_last = (std::cos(begins + kPhase) - std::cos(ends + kPhase)) / (ends - begins) +
                           kSine * (std::cos(2.0 * begins) - std::cos(2.0 * ends)) / (2.0 * (ends - begins)) +
                           kCosine * (std::sin(2.0 * ends) - std::sin(2.0 * begins)) / (2.0 * (ends - begins));
    EXPECT_NEAR(sample.applied_torque[1], 10.0 + (1.0 - kShare) * kAmplitude * of_last, 1e-4);
  }
}

}  // namespace
}  // namespace slewlab::sim
