#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/integrate/plant.h"
#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// Rigid crane under constant torque T per group: T = T_g (1 + loss) + J_m a, N T_g = J a. At a thousand times the
// sliding speed the teeth lose all but 1e-6 of their share.
TEST(GearFriction, CostsItsShareOfTheGearTorque) {
  CraneParameters crane = rigid_crane();
  crane.drive.gear_damping_ratio = 0.5;
  const auto samples = run(crane, "gear_friction", {0.1, 5e-5}, 6.0, constant_drive(100.0, 100.0));
  const double driven = house_and_boom_inertia(crane);
  const double motors = whole_inertia(crane) - driven;
  const double expected = 2.0 * 100.0 * torque_factor(crane) / (motors + 1.1 * driven);
  const double measured = (samples[5999].house_speed - samples[3999].house_speed) / 2.0;
  EXPECT_NEAR(measured, expected, 1e-4 * expected);
}

// Against the motor's motion, whichever flank carries: loss |T| x / sqrt(1 + x^2), x = 3/4 gives 3/5.
TEST(GearFriction, PassesZeroWithTheSpeed) {
  const PlantModel model = make_plant_model(rigid_crane(), 0.001);
  const std::vector<double> values{0.1, 4e-4};
  const auto effect = started("gear_friction", values, model);
  for (const double carried : {1e6, -1e6}) {
    const auto at = [&](double speed) {
      EffectMoment moment;
      moment.gear_torque[1] = carried;
      moment.motor_speed[0] = moment.motor_speed[1] = speed;
      PortForces ports;
      effect->force(moment, ports);
      EXPECT_EQ(ports.motor_torque[0], 0.0);  // carries nothing
      EXPECT_EQ(ports.house_torque, 0.0);
      return ports.motor_torque[1];
    };
    EXPECT_EQ(at(0.0), 0.0);
    EXPECT_NEAR(at(3e-4), -0.6e5, 1e-9);
    EXPECT_NEAR(at(-3e-4), 0.6e5, 1e-9);
    EXPECT_NEAR(at(4.0), -1e5, 1e-3);
    EXPECT_NEAR(at(-4.0), 1e5, 1e-3);
  }
}

// Against a fixed house the motors come to rest where the gears alone hold the torque, however much the teeth lose.
TEST(GearFriction, HoldsNothingAtRest) {
  const CraneParameters crane = fixed_house();
  const auto samples = run(crane, "gear_friction", {0.2, 3e-4}, 20.0, constant_drive(100.0, -60.0));
  EXPECT_NEAR(samples.back().gear_torque[0], 100.0 * torque_factor(crane), 1e-6 * torque_factor(crane));
  EXPECT_NEAR(samples.back().gear_torque[1], -60.0 * torque_factor(crane), 1e-6 * torque_factor(crane));
}

// Explicit at its stiffest, loss 0.4 at the lowest sliding speed: gears wound up by 1 MNm, and by the 3 MNm of drives near
// their limit, give way to a hundredth more as they do at an eighth of the step.
TEST(GearFriction, IsStableAtAMillisecond) {
  CraneParameters crane = fixed_house();
  crane.drive.gear_damping_ratio = 0.03;
  for (const double carried : {1e6, 3e6}) {
    const double drive = 1.01 * carried / torque_factor(crane);
    const auto of_step = [&](double step) {
      return run({.crane = crane, .effects = {{"gear_friction", {0.4, 5e-5}}}, .step = step}, 1.0,
                 constant_drive(drive, -drive), {.gear_torque = {carried, -carried}});
    };
    const auto coarse = of_step(0.001), fine = of_step(0.000125);
    const double moved = fine.back().motor_angle[0] - fine.front().motor_angle[0];
    EXPECT_GT(moved, 1e-6);
    double worst = 0.0, least_speed = 1.0;
    for (std::size_t k = 0; k < coarse.size(); ++k) {
      worst = std::max(worst, std::fabs(coarse[k].motor_angle[0] - fine[8 * k + 7].motor_angle[0]));
      least_speed = std::min(least_speed, coarse[k].motor_speed[0]);
    }
    EXPECT_LT(worst, 0.01 * moved);
    EXPECT_GE(least_speed, 0.0);  // overdamped: never back
  }
}

}  // namespace
}  // namespace slewlab::sim
