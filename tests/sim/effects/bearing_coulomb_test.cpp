#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "sim/integrate/plant.h"
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

// The held torque grows with the angle, without a jump where it changes its side and level.
TEST(BearingCoulomb, HeldTorqueIsContinuousThroughZero) {
  constexpr double kTorque = 2e5, kAsymmetry = 0.4, kGive = 3e-5, kMove = 0.01 * kGive;
  const PlantModel model = make_plant_model(rigid_crane(), 0.001);
  const std::vector<double> values{kTorque, kAsymmetry, kGive};
  const auto effect = started("bearing_coulomb", values, model);
  EffectMoment moment;
  double before = 0.0, angle = 0.0;
  for (const double side : {1.0, -1.0, 1.0}) {
    for (int k = 0; k < 1000; ++k) {
      angle += side * kMove;
      moment.house_angle = angle;
      PortForces ports;
      effect->force(moment, ports);
      const double growth = side * (before - ports.house_torque);
      EXPECT_GE(growth, 0.0);
      EXPECT_LE(growth, 2.0 * kTorque * (1.0 + kAsymmetry) * kMove / kGive);  // turned back: twice as stiff
      before = ports.house_torque;
    }
    const double level = kTorque * (1.0 + side * kAsymmetry);
    EXPECT_NEAR(before, -side * level, 2.0 * std::exp(-9.99) * level);  // after a path of ten times the give
  }
}

}  // namespace
}  // namespace slewlab::sim
