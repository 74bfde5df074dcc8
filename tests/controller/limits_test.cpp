#include "controller/limits.h"

#include <gtest/gtest.h>

#include <limits>

namespace slewlab::controller {
namespace {

TEST(Limits, HoldTheTorque) {
  const TorqueLimits limits{400.0, std::numeric_limits<double>::infinity()};
  EXPECT_EQ(limited_torque(limits, 0.01, 0.0, 500.0), 400.0);
  EXPECT_EQ(limited_torque(limits, 0.01, 0.0, -500.0), -400.0);
  EXPECT_EQ(limited_torque(limits, 0.01, 0.0, 399.0), 399.0);
}

// 1000 N m/s is 1 N m in 1 ms and 20 N m in 20 ms.
TEST(Limits, HoldTheRateForEveryPeriod) {
  const TorqueLimits limits{400.0, 1000.0};
  for (const double period : {1e-3, 2e-3, 5e-3, 10e-3, 20e-3}) {
    EXPECT_DOUBLE_EQ(limited_torque(limits, period, 50.0, 400.0), 50.0 + 1000.0 * period);
    EXPECT_DOUBLE_EQ(limited_torque(limits, period, 50.0, -400.0), 50.0 - 1000.0 * period);
  }
  EXPECT_EQ(limited_torque(limits, 1e-3, 50.0, 50.5), 50.5);
}

}  // namespace
}  // namespace slewlab::controller
