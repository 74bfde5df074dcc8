#include "controller/speed_filter.h"

#include <gtest/gtest.h>

#include <cmath>

namespace slewlab::controller {
namespace {

TEST(SpeedFilter, StepResponseIsExponentialForEveryPeriod) {
  for (const double period : {1e-3, 5e-3, 20e-3}) {
    double speed = 0.0;
    const int steps = static_cast<int>(std::lround(0.1 / period));
    for (int i = 0; i < steps; ++i) speed = filtered_speed(0.05, period, speed, 1.0);
    EXPECT_NEAR(speed, 1.0 - std::exp(-0.1 / 0.05), 1e-12) << period;
  }
}

TEST(SpeedFilter, ZeroTimeConstantPassesTheMeasurementOn) { EXPECT_EQ(filtered_speed(0.0, 0.01, 3.0, 7.0), 7.0); }

}  // namespace
}  // namespace slewlab::controller
