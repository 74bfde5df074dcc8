#include <gtest/gtest.h>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

TEST(CommandDelay, ShiftsTorqueAndEnable) {
  const auto samples = run(fixed_house(), "command_delay", {0.0025}, 0.03, [](double time) {
    DriveCommand command;
    command.motor_torque = {1000.0 * time, 0.0};
    command.enable = time < 0.0095;
    return command;
  });
  for (std::size_t k = 3; k < 13; ++k) {
    EXPECT_NEAR(samples[k].applied_torque[0], static_cast<double>(k) - 2.5, 1e-9) << k;
  }
  EXPECT_EQ(samples[13].applied_torque[0], 0.0) << "disabled 3.5 ms ago";
}

}  // namespace
}  // namespace slewlab::sim
