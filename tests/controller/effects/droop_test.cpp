#include <gtest/gtest.h>

#include "tests/controller/effects/change_by.h"

namespace slewlab::controller {
namespace {

// At rated torque the droop takes its whole value from the reference: the PI then sees no error.
TEST(DroopEffect, RatedTorqueLowersTheReferenceByTheDroop) {
  ControllerSettings settings;
  settings.speed_control = {.proportional_gain = 40.0, .integral_time = 1.0, .droop = 0.0};
  change_by("droop", {5.0}, settings);
  SpeedControlState state{.integral_torque = 400.0};
  const SpeedControlOutput output =
      step_speed_control(settings.speed_control, state, 1e-9, 5.0, 400.0, 800.0);
  EXPECT_NEAR(output.torque, 400.0, 1e-4);
  EXPECT_NEAR(output.proportional_torque, 0.0, 1e-4);
}

}  // namespace
}  // namespace slewlab::controller
