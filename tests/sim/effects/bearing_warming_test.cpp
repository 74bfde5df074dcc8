#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// Coasting on dry friction, the crane loses T_c ((1 - f) s + f s_w (1 - exp(-s / s_w))) on the way s from the start.
TEST(BearingWarming, FallsWithTheWay) {
  const CraneParameters crane = rigid_crane_without_play();
  constexpr double kTorque = 1e5, kFall = 0.8, kWay = 0.05;
  const auto work = [&](double way) { return kTorque * ((1.0 - kFall) * way - kFall * kWay * std::expm1(-way / kWay)); };
  for (const double side : {1.0, -1.0}) {
    const auto samples = run(crane, "bearing_warming", {kTorque, 0.0, kFall, kWay, 0.0, 0.0}, 9.0, no_drive, {.slew_speed = side * 0.02});
    for (const std::size_t end : {3999u, 7999u}) {
      const double expected = work(std::fabs(samples[end].house_angle)) - work(std::fabs(samples[1499].house_angle));
      EXPECT_NEAR(motion_lost(crane, samples[1499], samples[end]), expected, 2e-3 * expected);
    }
  }
}

// Of its viscous part, cold all the time: exp(-d t / J).
TEST(BearingWarming, WithoutFallIsViscous) {
  const CraneParameters crane = rigid_crane_without_play();
  const auto samples = run(crane, "bearing_warming", {0.0, 1e7, 0.0, 1.0, 0.0, 0.0}, 8.0, no_drive, {.slew_speed = 0.02});
  EXPECT_NEAR(samples[7999].house_speed / samples[2999].house_speed, std::exp(-5.0 * 1e7 / whole_inertia(crane)), 2e-4);
}

// At rest it holds, warm or cold; without fall its dry part is bearing_coulomb, to the bit.
TEST(BearingWarming, HoldsAtRest) {
  const CraneParameters crane = rigid_crane_without_play();
  const auto stopped = run(crane, "bearing_warming", {3e5, 0.0, 0.5, 0.03, 0.0, 0.0}, 15.0, no_drive, {.slew_speed = 0.02});
  EXPECT_NEAR(stopped.back().house_speed, 0.0, 1e-12);
  for (const double give : {0.0, 5e-5}) {
    const auto warming = run(crane, "bearing_warming", {2e5, 0.0, 0.0, 1.0, 0.2, give}, 4.0, no_drive, {.slew_speed = 0.01});
    const auto coulomb = run(crane, "bearing_coulomb", {2e5, 0.2, give}, 4.0, no_drive, {.slew_speed = 0.01});
    EXPECT_EQ(warming.back().house_angle, coulomb.back().house_angle);
  }
}

}  // namespace
}  // namespace slewlab::sim
