#include <gtest/gtest.h>

#include "tests/controller/effects/change_by.h"

namespace slewlab::controller {
namespace {

TEST(OtherGains, MultipliesGainAndIntegralTime) {
  ControllerSettings settings;
  settings.speed_control = {.proportional_gain = 40.0, .integral_time = 1.0};
  change_by("other_gains", {1.5, 0.5}, settings);
  // A step of the error e gives Kp e at once and Kp / Ti e per second besides.
  SpeedControlState state;
  const double period = 1e-6;
  EXPECT_NEAR(step_speed_control(settings.speed_control, state, period, 2.0, 400.0, 1e9).torque, 60.0 * 2.0,
              1e-3);
  double torque = 0.0;
  for (int k = 0; k < 1000; ++k) {
    torque = step_speed_control(settings.speed_control, state, 1e-3, 2.0, 400.0, 1e9).torque;
  }
  EXPECT_NEAR(torque, 60.0 * 2.0 * (1.0 + 1.0 / 0.5), 0.5);
}

}  // namespace
}  // namespace slewlab::controller
