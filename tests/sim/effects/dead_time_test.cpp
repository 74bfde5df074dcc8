#include <gtest/gtest.h>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// A command that rises by 1 Nm per step comes 2.5 steps late: as the mean of the two around it.
TEST(DeadTime, ShiftsByWholeAndHalfSteps) {
  const auto samples = run(fixed_house(), "dead_time", {0.0025}, 0.05, [](double time) {
    DriveCommand command;
    command.motor_torque = {1000.0 * time, 0.0};
    return command;
  });
  EXPECT_EQ(samples[1].applied_torque[0], 0.0);
  for (std::size_t k = 3; k < samples.size(); ++k) {
    EXPECT_NEAR(samples[k].applied_torque[0], static_cast<double>(k) - 2.5, 1e-9);
  }
}

}  // namespace
}  // namespace slewlab::sim
