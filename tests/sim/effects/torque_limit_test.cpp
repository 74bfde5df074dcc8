#include "sim/effects/torque_limit.h"

#include <gtest/gtest.h>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

TEST(TorqueLimit, CutsOnBothSidesAndLeavesTheRest) {
  const auto samples = run(fixed_house(), "torque_limit", {150.0}, 0.01, constant_drive(400.0, -200.0));
  EXPECT_EQ(samples.back().applied_torque[0], 150.0);
  EXPECT_EQ(samples.back().applied_torque[1], -150.0);
  const auto below = run(fixed_house(), "torque_limit", {150.0}, 0.01, constant_drive(149.0, 0.0));
  EXPECT_EQ(below.back().applied_torque[0], 149.0);
}

}  // namespace
}  // namespace slewlab::sim
