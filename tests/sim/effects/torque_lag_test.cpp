#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

constexpr double kLagStep = 0.001;  // [s]

// Step response of a first-order lag that began at 0, mean over the step that ends at `end` [s].
double mean_response(double time_constant, double end) {
  if (end < 0.5 * kLagStep) return 0.0;
  return 1.0 - time_constant / kLagStep * (std::exp(-(end - kLagStep) / time_constant) - std::exp(-end / time_constant));
}

// Behind a delay of n + s steps: the step response, 1 - s of it n steps late and s of it n + 1 steps.
TEST(TorqueLag, FollowsTheDelayedExponential) {
  constexpr double kTime = 0.05;
  for (const double share : {0.0, 0.21, 0.4, 0.5}) {
    const auto samples = run(fixed_house(), "torque_lag", {kTime, share}, 0.3, constant_drive(100.0, -50.0));
    const double tau = (1.0 - share) * kTime, delay = share * kTime / kLagStep;
    const double whole = std::floor(delay + 1e-9), part = delay - whole;
    for (const BenchSample& sample : samples) {
      const double mean = (1.0 - part) * mean_response(tau, sample.time - whole * kLagStep) +
                          part * mean_response(tau, sample.time - (whole + 1.0) * kLagStep);
      EXPECT_NEAR(sample.applied_torque[0], 100.0 * mean, 1e-9) << share << " " << sample.time;
      EXPECT_NEAR(sample.applied_torque[1], -50.0 * mean, 1e-9) << share << " " << sample.time;
    }
  }
}

// A ramp in steps, u_k = r k h: of the steady answer, tau (T_(k+1) - T_k) / h = u - mean says that its mean over a step
// lags by tau; the delay adds the rest of the time. exp(-2 / 0.05) of the beginning is left.
TEST(TorqueLag, RampComesTheWholeTimeLateAtEveryShare) {
  constexpr double kRate = 100.0;  // [Nm/s]
  for (const double time : {0.0123, 0.05}) {
    for (const double share : {0.0, 0.17, 0.37, 0.5}) {
      const auto samples = run(fixed_house(), "torque_lag", {time, share}, 2.0, [](double now) {
        DriveCommand command;
        command.motor_torque = {kRate * now, -kRate * now};
        return command;
      });
      const double late = samples.back().time - kLagStep - samples.back().applied_torque[0] / kRate;
      EXPECT_NEAR(late, time, 1e-12) << time << " " << share;
      EXPECT_EQ(samples.back().applied_torque[1], -samples.back().applied_torque[0]);
    }
  }
}

}  // namespace
}  // namespace slewlab::sim
