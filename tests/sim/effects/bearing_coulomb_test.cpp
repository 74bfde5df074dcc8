#include "sim/effects/bearing_coulomb.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// A rigid crane coasts to rest at T / J, by direction, and stays.
TEST(BearingCoulomb, StopsACoastingCraneByDirection) {
  CraneParameters crane = rigid_crane();
  crane.drive.gear_damping_ratio = 0.5;
  crane.drive.gearbox_play = crane.drive.pinion_play = 0.0;
  for (const double side : {1.0, -1.0}) {
    const auto samples =
        run(crane, "bearing_coulomb", {2e5, 0.3}, 20.0, no_drive, {.slew_speed = side * 0.02});
    const double expected = side * 2e5 * (1.0 + side * 0.3) / whole_inertia(crane);
    EXPECT_NEAR((samples[1499].house_speed - samples[3499].house_speed) / 2.0, expected,
                1e-3 * std::fabs(expected));
    EXPECT_NEAR(samples.back().house_speed, 0.0, 1e-12);
  }
}

}  // namespace
}  // namespace slewlab::sim
