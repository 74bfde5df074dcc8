#include "sim/effects/command_loss.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

TEST(CommandLoss, HoldsTheLastThatArrived) {
  const auto samples = run(fixed_house(), "command_loss", {0.3}, 30.0, [](double time) {
    DriveCommand command;
    command.sequence = std::lround(std::floor(time / 0.010 + 1e-6)) + 1;
    command.motor_torque = {static_cast<double>(command.sequence), 0.0};
    return command;
  });
  int lost = 0, count = 0;
  for (std::size_t k = 9; k < samples.size(); k += 10) {
    const double sent = static_cast<double>(k / 10 + 1);
    const double held = samples[k].applied_torque[0];
    ++count;
    if (held == sent) continue;
    ++lost;
    const double before = k >= 10 ? samples[k - 10].applied_torque[0] : 0.0;
    EXPECT_EQ(held, before) << k;
  }
  // 3000 messages: one standard deviation of the share is 0.008.
  EXPECT_NEAR(static_cast<double>(lost) / count, 0.3, 0.03);
}

}  // namespace
}  // namespace slewlab::sim
