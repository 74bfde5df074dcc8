#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

DriveCommand numbered(double time) {
  DriveCommand command;
  command.sequence = std::lround(std::floor(time / 0.010 + 1e-6));
  command.motor_torque = {static_cast<double>(command.sequence), 0.0};
  return command;
}

// Delays drawn evenly from 0 ... 5 ms, shorter than the 10 ms between messages: 2.5 ms in the mean.
TEST(CommandJitter, DelaysByHalfItsSpreadInTheMean) {
  const auto samples = run(fixed_house(), "command_jitter", {0.005}, 20.0, numbered);
  double late = 0.0;
  for (std::size_t k = 10; k < samples.size(); ++k) {
    const std::size_t message = k / 10;
    const auto sent = static_cast<double>(message);
    const double held = samples[k].applied_torque[0];
    ASSERT_TRUE(held == sent || held == sent - 1.0) << k;
    if (k % 10 > 5) {
      ASSERT_EQ(held, sent) << k;
    }
    late += held == sent ? 0.0 : 1.0;
  }
  EXPECT_NEAR(late / (static_cast<double>(samples.size() - 10) / 10.0), 2.5, 0.15);
}

// A spread of several messages: none is lost in the end, none overtakes.
TEST(CommandJitter, KeepsTheOrder) {
  const auto samples = run(fixed_house(), "command_jitter", {0.05}, 5.0, numbered);
  for (std::size_t k = 1; k < samples.size(); ++k) {
    EXPECT_GE(samples[k].applied_torque[0], samples[k - 1].applied_torque[0]);
    EXPECT_GE(samples[k].applied_torque[0], std::floor(static_cast<double>(k) / 10.0) - 6.0);
  }
}

}  // namespace
}  // namespace slewlab::sim
