#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/model/gear.h"
#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

TEST(GearboxMeshVariation, StiffensTheGearsAtItsTop) {
  // The motor turns while the gears wind up; a stiff drive keeps that small, and the phase follows it.
  CraneParameters crane = fixed_house();
  const auto samples = run(crane, "gearbox_mesh_variation", {0.05, 0.0, 0.0, 0.0}, 8.0, constant_drive(100.0, 100.0));
  const double wound = 100.0 * torque_factor(crane) / group_gear_stiffness(crane);
  const BenchSample& end = samples.back();
  const double order =
      planetary_mesh_frequency(110, 8, 1.0) * torque_factor(crane) / crane.drive.motors_per_group;
  EXPECT_NEAR(end.deflection[0],
              group_half_play(crane) + wound / (1.0 + 0.05 * std::sin(order * end.motor_angle[0])),
              1e-6 * wound);
}

// A ring and a sun of 60 and 30 teeth mesh 60 * 30 / 90 = 20 times per turn of the motor.
TEST(GearboxMeshVariation, GoesWithTheMachinesTeeth) {
  CraneParameters crane = fixed_house();
  crane.drive.gearbox_ring_teeth = 60;
  crane.drive.gearbox_sun_teeth = 30;
  const auto samples = run(crane, "gearbox_mesh_variation", {0.05, 0.0, 0.0, 0.0}, 8.0, constant_drive(100.0, 100.0));
  const double wound = 100.0 * torque_factor(crane) / group_gear_stiffness(crane);
  const BenchSample& end = samples.back();
  const double order = 20.0 * torque_factor(crane) / crane.drive.motors_per_group;
  EXPECT_NEAR(end.deflection[0], group_half_play(crane) + wound / (1.0 + 0.05 * std::sin(order * end.motor_angle[0])), 1e-6 * wound);
}

// (2.2), Table 2.1: 149 meshes per second at 20 Hz of the motor. Where a whole mesh goes by in one step,
// nothing of it is left.
TEST(GearboxMeshVariation, FasterThanTheStepAveragesOut) {
  EXPECT_NEAR(planetary_mesh_frequency(110, 8, 20.0), 150.0, 1.0);
  CraneParameters crane = rigid_crane();
  const double ratio = torque_factor(crane) / crane.drive.motors_per_group;
  const double speed = 2.0 * std::numbers::pi / 0.001 / (planetary_mesh_frequency(110, 8, 1.0) * ratio);
  const double torque = 100.0 * torque_factor(crane);
  const auto samples = run(crane, "gearbox_mesh_variation", {0.05, 0.4, 0.0, 0.0}, 0.5, constant_drive(100.0, -100.0),
                           {.slew_speed = speed, .gear_torque = {torque, -torque}});
  EXPECT_NEAR(samples.back().gear_torque[0], torque, 1e-6 * torque);
}

}  // namespace
}  // namespace slewlab::sim
