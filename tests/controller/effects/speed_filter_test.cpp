#include <gtest/gtest.h>

#include <cmath>

#include "controller/speed_filter.h"
#include "tests/controller/effects/change_by.h"

namespace slewlab::controller {
namespace {

TEST(SpeedFilterEffect, AddsToTheTimeConstant) {
  ControllerSettings settings;
  change_by("speed_filter", {0.05}, settings);
  // One time constant after a step the filtered speed has come 1 - 1/e of the way.
  double speed = 0.0;
  for (int k = 0; k < 50; ++k) speed = filtered_speed(settings.speed_filter_time, 0.001, speed, 1.0);
  EXPECT_NEAR(speed, 1.0 - std::exp(-1.0), 1e-12);
}

}  // namespace
}  // namespace slewlab::controller
