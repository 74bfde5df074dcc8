#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// A rigid crane coasts with exp(-d t / J), d by direction.
TEST(BearingViscous, SlowsExponentially) {
  CraneParameters crane = rigid_crane();
  crane.drive.gear_damping_ratio = 0.5;
  crane.drive.gearbox_play = crane.drive.pinion_play = 0.0;
  for (const double side : {1.0, -1.0}) {
    const auto samples =
        run(crane, "bearing_viscous", {1e7, 0.4}, 8.0, no_drive, {.slew_speed = side * 0.02});
    const double rate = 1e7 * (1.0 + side * 0.4) / whole_inertia(crane);
    EXPECT_NEAR(samples[7999].house_speed / samples[2999].house_speed, std::exp(-5.0 * rate), 2e-4);
  }
}

}  // namespace
}  // namespace slewlab::sim
