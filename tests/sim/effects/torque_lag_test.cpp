#include "sim/effects/torque_lag.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// Step response of a first-order lag, mean over each step.
TEST(TorqueLag, FollowsTheExponential) {
  constexpr double kTau = 0.05, kStep = 0.001;
  const auto samples = run(fixed_house(), "torque_lag", {kTau}, 0.3, constant_drive(100.0, -50.0));
  for (const BenchSample& sample : samples) {
    const double t0 = sample.time - kStep;
    const double mean = 1.0 - kTau / kStep * (std::exp(-t0 / kTau) - std::exp(-sample.time / kTau));
    EXPECT_NEAR(sample.applied_torque[0], 100.0 * mean, 1e-9);
    EXPECT_NEAR(sample.applied_torque[1], -50.0 * mean, 1e-9);
  }
}

}  // namespace
}  // namespace slewlab::sim
