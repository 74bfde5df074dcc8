#include "sim/effects/bearing_coulomb.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/effects/presliding.h"
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
        run(crane, "bearing_coulomb", {2e5, 0.3, 0.0}, 20.0, no_drive, {.slew_speed = side * 0.02});
    const double expected = side * 2e5 * (1.0 + side * 0.3) / whole_inertia(crane);
    EXPECT_NEAR((samples[1499].house_speed - samples[3499].house_speed) / 2.0, expected,
                1e-3 * std::fabs(expected));
    EXPECT_NEAR(samples.back().house_speed, 0.0, 1e-12);
  }
}

// A bearing that gives slides as a dry one: the two coast to rest within the angle by which it gives.
TEST(BearingCoulomb, SlidesTheSameWhereItGives) {
  CraneParameters crane = rigid_crane();
  crane.drive.gear_damping_ratio = 0.5;
  crane.drive.gearbox_play = crane.drive.pinion_play = 0.0;
  const auto dry = run(crane, "bearing_coulomb", {2e5, 0.0, 0.0}, 20.0, no_drive, {.slew_speed = 0.02});
  const auto giving = run(crane, "bearing_coulomb", {2e5, 0.0, 5e-5}, 20.0, no_drive, {.slew_speed = 0.02});
  const double travel = dry.back().house_angle - dry.front().house_angle;
  EXPECT_GT(travel, 100.0 * 5e-5);
  EXPECT_NEAR(giving.back().house_angle, dry.back().house_angle, 2.0 * 5e-5);
}

// The loop of a Jenkins element that swings by more than it gives: the work of a cycle is 4 level (amplitude - give); below
// that it is a spring and takes none.
TEST(Presliding, LosesTheWorkOfItsLoop) {
  for (const double amplitude : {0.8, 3.0}) {
    Presliding joint{.give = 1.0};
    double work = 0.0, before = 0.0;
    constexpr int kSteps = 20000;
    for (int n = 0; n <= 2 * kSteps; ++n) {  // the second cycle counts, the first one leads into the loop
      const double angle = amplitude * std::sin(2.0 * std::numbers::pi * n / kSteps);
      const double share = presliding_share(joint, angle);
      if (n > kSteps) work += share * (angle - before);
      before = angle;
    }
    EXPECT_NEAR(work, amplitude > 1.0 ? 4.0 * (amplitude - 1.0) : 0.0, 2e-3) << amplitude;
  }
}

}  // namespace
}  // namespace slewlab::sim
