#include "sim/integrate/plant_state.h"

#include <gtest/gtest.h>

#include "sim/model/drive_line.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::sim {
namespace {

constexpr double kStep = 1e-3;  // [s]

// The crane turned by `angle` [rad] and at `speed` [rad/s] as one body. The rigid mode is mass-normalised: house[0] rad per unit of it.
PlantState turned(const PlantModel& model, double angle, double speed) {
  PlantState state = make_plant_state(model);
  state.q[0] = angle / model.house[0];
  state.v[0] = speed / model.house[0];
  state.motor_angle.fill(angle);
  state.motor_speed.fill(speed);
  return state;
}

TEST(PlantState, BeginsAtRestWithFreeGears) {
  const PlantModel model = make_plant_model(thesis_crane(), kStep);
  const PlantState state = make_plant_state(model);
  EXPECT_EQ(mechanical_energy(model, state), 0.0);
  EXPECT_EQ(rope_angle(model, state), 0.0);
  EXPECT_EQ(gear_system(model, state).scale, 1.0);
}

// Gears pressed by a depth push with their stiffness times it, on the flank of its sign.
TEST(PlantState, RefreshFindsHouseAndGears) {
  const PlantModel model = make_plant_model(thesis_crane(), kStep);
  PlantState state = turned(model, 0.3, 0.01);
  const double depth = 1e-4;  // [rad]
  state.motor_angle[0] += model.gear[0].half_play + depth;
  state.motor_angle[1] -= model.gear[1].half_play + depth;
  refresh(model, state);
  EXPECT_NEAR(state.house_angle, 0.3, 1e-14);
  EXPECT_NEAR(state.house_speed, 0.01, 1e-15);
  EXPECT_EQ(state.contact[0], 1);
  EXPECT_EQ(state.contact[1], -1);
  EXPECT_NEAR(state.gear_torque[0], model.gear[0].stiffness * depth, 1e-9 * model.gear[0].stiffness * depth);
  EXPECT_NEAR(state.gear_torque[1], -state.gear_torque[0], 1e-9 * state.gear_torque[0]);
}

// One body in rotation has half its inertia times the square of its speed; each motor reads its speed times the ratio.
TEST(PlantState, EnergyAndReadingsOfOneBodyInRotation) {
  CraneParameters crane = thesis_crane();
  crane.load.mass = 0.0;
  const PlantModel model = make_plant_model(crane, kStep);
  PlantState state = turned(model, 0.3, 0.02);
  refresh(model, state);
  const double inertia = driven_inertia(crane) + model.group_inertia[0] + model.group_inertia[1];
  EXPECT_NEAR(mechanical_energy(model, state), 0.5 * inertia * 0.02 * 0.02, 1e-9 * inertia * 0.02 * 0.02);
  const PlantReadings readings = read(model, state);
  EXPECT_NEAR(readings.shaft_speed[1], 0.02 * total_ratio(crane.drive), 1e-12);
  EXPECT_NEAR(readings.shaft_position[0], 0.3 * total_ratio(crane.drive), 1e-10);
  EXPECT_NEAR(readings.slew_angle, 0.3, 1e-14);
  EXPECT_NEAR(readings.tip_acceleration, 0.0, 1e-12);
}

}  // namespace
}  // namespace slewlab::sim
