#include <gtest/gtest.h>

#include <algorithm>

#include "tests/controller/effects/change_by.h"

namespace slewlab::controller {
namespace {

// The S-curve reaches top speed after factor times its time, with the peak acceleration that area asks for.
TEST(OtherRamp, StretchesTheTimeToTopSpeed) {
  ControllerSettings settings;
  settings.ramp = {.shape = RampShape::s_curve,
                   .top_speed = 0.05,
                   .acceleration_time = 4.0,
                   .deceleration_time = 4.0,
                   .emergency_stop_time = 1.5,
                   .curved_share = 0.3};
  change_by("other_ramp", {1.5, 0.1}, settings);
  RampState state;
  double peak = 0.0;
  double reached = 0.0;
  for (int k = 1; k < 10000 && reached == 0.0; ++k) {
    step_ramp(settings.ramp, state, 0.001, 0.05);
    peak = std::max(peak, state.acceleration);
    if (state.speed >= 0.05) reached = 0.001 * k;
  }
  EXPECT_NEAR(reached, 6.0, 0.01);
  EXPECT_NEAR(peak, 0.05 / (6.0 * (1.0 - 0.4)), 1e-6);
  EXPECT_EQ(settings.ramp.emergency_stop_time, 1.5);
}

TEST(OtherRamp, KeepsTheCurvedShareWithinItsRange) {
  ControllerSettings settings;
  settings.ramp.curved_share = 0.3;
  change_by("other_ramp", {1.0, 0.5}, settings);
  EXPECT_EQ(settings.ramp.curved_share, 0.5);
}

}  // namespace
}  // namespace slewlab::controller
