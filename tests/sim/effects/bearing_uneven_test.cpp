#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// Coasting, the crane loses the integral of the friction over the way: T_c (theta + v / k (sin(k theta + phi))
// - a / 2k cos(2 k theta) + b / 2k sin(2 k theta)), k = 2 pi / l.
TEST(BearingUneven, TakesTheIntegralOverTheWay) {
  const CraneParameters crane = rigid_crane_without_play();
  constexpr double kTorque = 1e5, kVariation = 0.6, kLength = 0.08, kPhase = 0.7, kSine = 0.2, kCosine = -0.1;
  const double k = 2.0 * std::numbers::pi / kLength;
  const auto work = [&](double angle) {
    return kTorque * (angle + kVariation / k * std::sin(k * angle + kPhase) - 0.5 * kSine / k * std::cos(2.0 * k * angle) +
                      0.5 * kCosine / k * std::sin(2.0 * k * angle));
  };
  const auto samples = run(crane, "bearing_uneven", {kTorque, kVariation, kLength, kPhase, kSine, kCosine, 0.0, 0.0}, 9.0, no_drive, {.slew_speed = 0.02});
  for (const std::size_t end : {2999u, 4999u, 7999u}) {
    const double expected = work(samples[end].house_angle) - work(samples[1499].house_angle);
    EXPECT_NEAR(motion_lost(crane, samples[1499], samples[end]), expected, 2e-3 * expected);
  }
}

// At rest it holds what its place holds: twice the mean where the variation is 1 and the phase 0, next to nothing half a wavelength on.
TEST(BearingUneven, HoldsByItsPlace) {
  const CraneParameters crane = rigid_crane_without_play();
  constexpr double kTorque = 1e5;
  const double torque = 1.9 * kTorque / (2.0 * torque_factor(crane));  // [Nm] per motor
  const auto slowly = [&](double time) { return constant_drive(torque * std::min(1.0, time / 5.0), torque * std::min(1.0, time / 5.0))(time); };
  const auto holds = run(crane, "bearing_uneven", {kTorque, 1.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0}, 8.0, slowly);
  EXPECT_NEAR(holds.back().house_angle, 0.0, 1e-7);
  const auto slips = run(crane, "bearing_uneven", {kTorque, 1.0, 0.5, std::numbers::pi, 0.0, 0.0, 0.0, 0.0}, 8.0, slowly);
  EXPECT_GT(slips.back().house_angle, 1e-3);
}

// Even all along it is dry friction, to the bit; by direction, and where it gives before it slides as well.
TEST(BearingUneven, WithoutVariationIsCoulomb) {
  const CraneParameters crane = rigid_crane_without_play();
  for (const double give : {0.0, 5e-5}) {
    const auto uneven = run(crane, "bearing_uneven", {2e5, 0.0, 1.0, 0.3, 0.0, 0.0, 0.2, give}, 4.0, no_drive, {.slew_speed = 0.01});
    const auto coulomb = run(crane, "bearing_coulomb", {2e5, 0.2, give}, 4.0, no_drive, {.slew_speed = 0.01});
    EXPECT_EQ(uneven.back().house_angle, coulomb.back().house_angle);
  }
}

}  // namespace
}  // namespace slewlab::sim
