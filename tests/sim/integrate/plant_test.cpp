#include "sim/integrate/plant.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>

#include "sim/model/boom.h"
#include "sim/model/drive_line.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::sim {
namespace {

constexpr double kStep = 1e-3;  // [s]

CraneParameters rigid_crane_without_load() {
  CraneParameters crane = thesis_crane(0);
  crane.load.mass = 0.0;
  return crane;
}

// Closed form: inside the play the motors are free, so they reach the flank after sqrt(2 Delta_b J / T).
TEST(Plant, MotorsCrossTheirPlayFreelyAndMakeContactInTime) {
  const CraneParameters crane = thesis_crane();
  const PlantModel model = make_plant_model(crane, kStep);
  PlantWorkspace workspace = make_plant_workspace(model);
  PlantState state = make_plant_state(model);
  PlantInput input;
  input.motor_torque.fill(10.0);
  const double acceleration = 10.0 * 3 * model.ratio / model.group_inertia[0];
  const double contact_time = std::sqrt(2.0 * model.gear[0].half_play / acceleration);
  const auto steps = static_cast<int>(std::floor(contact_time / kStep));
  for (int i = 0; i < steps; ++i) step(model, workspace, input, state);
  const double t = steps * kStep;
  EXPECT_NEAR(state.motor_angle[0], 0.5 * acceleration * t * t, 1e-15);
  EXPECT_EQ(state.house_angle, 0.0);
  EXPECT_EQ(state.contact_changes, 0);
  step(model, workspace, input, state);
  EXPECT_EQ(state.contact[0], 1);
  EXPECT_EQ(state.contact[1], 1);
  EXPECT_GT(state.house_speed, 0.0);
}

// Conservation of angular momentum: without motors and load nothing outside turns the crane.
TEST(Plant, KeepsAngularMomentumThroughImpacts) {
  CraneParameters crane = thesis_crane();
  crane.load.mass = 0.0;
  const PlantModel model = make_plant_model(crane, kStep);
  PlantWorkspace workspace = make_plant_workspace(model);
  PlantState state = make_plant_state(model);
  state.motor_speed[0] = 0.02;
  state.motor_speed[1] = -0.005;
  const auto momentum = [&] {
    double sum = model.group_inertia[0] * (state.motor_speed[0] + state.motor_speed[1]);
    // The rigid mode is mass-normalised: its rotation per unit is 1/sqrt(J), so J omega = v_0 sqrt(J).
    sum += state.v[0] / model.house[0];
    return sum;
  };
  const double start = momentum();
  for (int i = 0; i < 20000; ++i) step(model, workspace, {}, state);
  EXPECT_GT(state.play_crossings[0] + state.play_crossings[1], 10);
  EXPECT_NEAR(momentum(), start, 1e-9 * std::fabs(start));
}

// Work-energy theorem with every damping off: what the motors put in is what the crane holds.
TEST(Plant, SuppliedWorkIsMechanicalEnergyWithoutDamping) {
  CraneParameters crane = thesis_crane();
  crane.drive.gear_damping_ratio = crane.boom.damping_ratio = crane.load.damping_ratio = 0.0;
  const PlantModel model = make_plant_model(crane, kStep);
  PlantWorkspace workspace = make_plant_workspace(model);
  PlantState state = make_plant_state(model);
  PlantInput input;
  for (int i = 0; i < 10000; ++i) {
    input.motor_torque[0] = 120.0 * std::sin(2.0 * std::numbers::pi * i * kStep / 3.0);
    input.motor_torque[1] = input.motor_torque[0] - 20.0;
    step(model, workspace, input, state);
  }
  EXPECT_GT(state.play_crossings[0], 0);
  EXPECT_NEAR(mechanical_energy(model, state), state.supplied_work, 1e-4 * state.supplied_work);
}

// Closed form: a rigid crane under Coulomb friction below and above its level.
TEST(Plant, HouseFrictionSticksAndSlides) {
  const CraneParameters crane = rigid_crane_without_load();
  const PlantModel model = make_plant_model(crane, kStep);
  PlantWorkspace workspace = make_plant_workspace(model);
  PlantState state = make_plant_state(model);
  PlantInput input;
  input.friction.house_positive = input.friction.house_negative = 2e5;
  input.ports.house_torque = 1.5e5;
  for (int i = 0; i < 1000; ++i) step(model, workspace, input, state);
  EXPECT_NEAR(state.house_speed, 0.0, 1e-15);
  EXPECT_NEAR(state.house_angle, 0.0, 1e-15);

  input.ports.house_torque = 3.0e5;
  const double inertia = driven_inertia(crane);
  state = make_plant_state(model);
  for (int i = 0; i < 100; ++i) step(model, workspace, input, state);
  // The gears take up nothing before the play is used up.
  ASSERT_LT(state.house_angle, model.gear[0].half_play);
  EXPECT_NEAR(state.house_speed, (3.0e5 - 2e5) / inertia * 0.1, 1e-12);
}

// A brake is friction on the motors: it stops them after omega J / level and holds them against a torque.
TEST(Plant, BrakeStopsAndHoldsTheMotors) {
  const CraneParameters crane = rigid_crane_without_load();
  const PlantModel model = make_plant_model(crane, kStep);
  PlantWorkspace workspace = make_plant_workspace(model);
  PlantState state = make_plant_state(model);
  state.motor_speed[0] = state.motor_speed[1] = state.house_angle = 0.0;
  state.motor_speed[0] = 1e-4;
  PlantInput input;
  const double level = 1e4;
  input.friction.motor[0] = input.friction.motor[1] = level;
  const double stop = 1e-4 * model.group_inertia[0] / level;
  const auto steps = static_cast<int>(std::ceil(stop / kStep)) + 1;
  for (int i = 0; i < steps; ++i) step(model, workspace, input, state);
  EXPECT_NEAR(state.motor_speed[0], 0.0, 1e-15);
  EXPECT_NEAR(state.motor_angle[0], 0.5 * 1e-4 * stop, 0.5 * 1e-4 * kStep);
  input.motor_torque[0] = 0.9 * level / (3 * model.ratio);
  for (int i = 0; i < 500; ++i) step(model, workspace, input, state);
  EXPECT_NEAR(state.motor_speed[0], 0.0, 1e-15);
}

// Gears as stiff as one piece, brakes on the motors and friction in the bearing, a house as heavy as a few motors and as
// thousands: at every step each body stands still, or its friction is at its level and opposes it.
TEST(Plant, FrictionsOfStifflyCoupledBodiesKeepToTheirLaw) {
  for (const auto& [stiffer, heavier] : {std::pair{1.0, 1.0}, {10.0, 1e2}, {1e2, 1e3}, {1e3, 1e4}, {1e4, 1e2}, {1e5, 1e4}}) {
    CraneParameters crane = rigid_crane_without_load();
    crane.house.inertia *= heavier;
    crane.drive.group_count = 3;
    crane.drive.gearbox_stiffness *= stiffer;
    const PlantModel model = make_plant_model(crane, kStep);
    PlantWorkspace workspace = make_plant_workspace(model);
    PlantState state = make_plant_state(model);
    for (int i = 0; i < 3; ++i) {
      state.motor_speed[i] = 0.05;
      state.motor_angle[i] = (i == 1 ? -1.0 : 1.0) * model.gear[i].half_play;
    }
    state.v[0] = 0.05 / model.house[0];
    refresh(model, state);
    PlantInput input;
    const double bearing = 2e6 * heavier;  // [Nm]
    input.friction.house_positive = input.friction.house_negative = bearing;
    for (int i = 0; i < 3; ++i) input.friction.motor[i] = 3.3e6 * heavier * (1.0 + 0.3 * i);  // of a group's brakes: 3.3e6
    double slowest = 1.0;
    for (int n = 0; n < 1000; ++n) {
      step(model, workspace, input, state);
      ASSERT_TRUE(std::isfinite(state.house_speed)) << "stiffer by " << stiffer << ", step " << n;
      constexpr double kStanding = 1e-11;  // [rad/s] of 0.05
      constexpr double kAtLevel = 1e-9;   // [-]
      const auto keeps = [&](double speed, double friction, double level) {
        if (std::fabs(speed) <= kStanding) return std::fabs(friction) <= level * (1.0 + kAtLevel);
        return friction * speed < 0.0 && std::fabs(std::fabs(friction) / level - 1.0) <= kAtLevel;
      };
      for (int i = 0; i < 3; ++i) {
        ASSERT_TRUE(keeps(state.motor_speed[i], state.motor_friction[i], input.friction.motor[i]))
            << "stiffer by " << stiffer << ", step " << n << ", group " << i << ": " << state.motor_speed[i] << " rad/s, "
            << state.motor_friction[i] << " Nm";
      }
      ASSERT_TRUE(keeps(state.house_speed, state.house_friction, bearing))
          << "stiffer by " << stiffer << ", step " << n << ": " << state.house_speed << " rad/s, " << state.house_friction << " Nm";
      slowest = std::min(slowest, std::fabs(state.house_speed));
    }
    EXPECT_LE(slowest, 1e-9) << "stiffer by " << stiffer << ": the house came to rest";
    EXPECT_EQ(state.unsolved_frictions, 0) << "stiffer by " << stiffer;
  }
}

// A thrown-in check of the load: with the tip held by a heavy house it swings as (2.17) says for a point load.
TEST(Plant, PointLoadSwingsWithThePendulumPeriod) {
  CraneParameters crane = thesis_crane(0);
  crane.house.inertia = 1e14;  // [kg m^2] so heavy that the tip rests
  crane.load.rod_length = 0.0;
  crane.load.damping_ratio = 0.0;
  const PlantModel model = make_plant_model(crane, kStep);
  PlantWorkspace workspace = make_plant_workspace(model);
  PlantState state = make_plant_state(model);
  state.load_q[0] = 0.05 * 60.0 / model.load.modes(0, 0);  // 0.05 rad
  refresh(model, state);
  ASSERT_NEAR(rope_angle(model, state), 0.05, 1e-12);
  const double period = 2.0 * std::numbers::pi * std::sqrt(60.0 / kGravity);
  const int steps = static_cast<int>(std::lround(period / kStep));
  for (int i = 0; i < steps; ++i) step(model, workspace, {}, state);
  const double expected = 0.05 * std::cos(2.0 * std::numbers::pi * steps * kStep / period);
  EXPECT_NEAR(rope_angle(model, state), expected, 1e-6);
}

TEST(Plant, TwoInstancesSideBySideStayEqualBitForBit) {
  const CraneParameters crane = thesis_crane();
  const PlantModel first_model = make_plant_model(crane, kStep);
  const PlantModel second_model = make_plant_model(crane, kStep);
  PlantWorkspace first_workspace = make_plant_workspace(first_model);
  PlantWorkspace second_workspace = make_plant_workspace(second_model);
  PlantState first = make_plant_state(first_model);
  PlantState second = make_plant_state(second_model);
  PlantInput input;
  for (int i = 0; i < 5000; ++i) {
    input.motor_torque[0] = 150.0 * std::sin(0.002 * i);
    input.motor_torque[1] = -0.5 * input.motor_torque[0];
    step(first_model, first_workspace, input, first);
    step(second_model, second_workspace, input, second);
    ASSERT_EQ(0, std::memcmp(first.q.data(), second.q.data(), first.q.size() * sizeof(double)));
    ASSERT_EQ(0, std::memcmp(first.v.data(), second.v.data(), first.v.size() * sizeof(double)));
    ASSERT_EQ(first.motor_angle, second.motor_angle);
    ASSERT_EQ(first.load_q, second.load_q);
  }
  EXPECT_GT(first.contact_changes, 0);
}

// Degenerate machines: the same step serves them.
TEST(Plant, RunsRigidUnloadedSingleGroupMachines) {
  CraneParameters crane = rigid_crane_without_load();
  crane.drive.group_count = 1;
  crane.drive.motors_per_group = 6;
  const PlantModel model = make_plant_model(crane, kStep);
  EXPECT_EQ(model.mode_count, 1);
  PlantWorkspace workspace = make_plant_workspace(model);
  PlantState state = make_plant_state(model);
  PlantInput input;
  input.motor_torque[0] = 100.0;
  for (int i = 0; i < 20000; ++i) step(model, workspace, input, state);
  // Newton: torque times time is angular momentum, whatever the gears do in between.
  const double momentum = model.group_inertia[0] * state.motor_speed[0] + driven_inertia(crane) * state.house_speed;
  EXPECT_NEAR(momentum, 100.0 * 6 * model.ratio * 20.0, 1e-9 * momentum);
}

}  // namespace
}  // namespace slewlab::sim
