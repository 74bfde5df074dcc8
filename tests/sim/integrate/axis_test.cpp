// A plain axis in plant and reference: one inertia against closed forms, an elastic one against SUNDIALS, and the limits
// between the two.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "sim/integrate/plant.h"
#include "sim/integrate/reference.h"
#include "sim/model/crane.h"
#include "sim/model/drive_line.h"
#include "tests/common/allocation_guard.h"

namespace slewlab::sim {
namespace {

constexpr double kStep = 1e-3;      // [s]
constexpr double kInertia = 12.0;   // [kg m^2] of what the motor moves
constexpr double kMotor = 0.002;    // [kg m^2] on the motor shaft
constexpr double kRatio = 50.0;     // [-]
constexpr double kTotal = kInertia + kMotor * kRatio * kRatio;  // 17 kg m^2 on the axis

CraneParameters rigid_axis() {
  CraneParameters axis;
  axis.boom.element_count = 0;
  axis.drive.group_count = axis.drive.motors_per_group = 1;
  axis.drive.is_rigid = true;
  axis.drive.motor_inertia = kMotor;
  axis.drive.gearbox_ratio = kRatio;
  axis.drive.rated_torque = 8.0;
  axis.drive.top_speed = 2.0;
  axis.house.inertia = kInertia;
  return axis;
}

CraneParameters elastic_axis() {
  CraneParameters axis = rigid_axis();
  axis.drive.is_rigid = false;
  axis.drive.gearbox_stiffness = 2e5;  // [Nm/rad], 38 Hz
  axis.drive.gear_damping_ratio = 0.05;
  axis.drive.gearbox_play = 1e-3;  // [rad]
  return axis;
}

struct Simulated {
  PlantModel model;
  PlantWorkspace workspace;
  PlantState state;
  PlantInput input;

  explicit Simulated(const CraneParameters& axis, double length = kStep)
      : model(make_plant_model(axis, length)), workspace(make_plant_workspace(model)), state(make_plant_state(model)) {}
  void run(int steps) {
    for (int i = 0; i < steps; ++i) step(model, workspace, input, state);
  }
};

void start_at(Simulated& axis, double angle, double speed) {
  axis.state.q[0] = angle / axis.model.house[0];
  axis.state.v[0] = speed / axis.model.house[0];
  refresh(axis.model, axis.state);
}

TEST(RigidAxis, ConstantTorqueGivesConstantAcceleration) {
  Simulated axis(rigid_axis());
  axis.input.motor_torque[0] = 4.0;  // [Nm] at the motor: 200 Nm on the axis
  axis.run(1500);
  const double t = 1.5, acceleration = 4.0 * kRatio / kTotal;
  EXPECT_NEAR(axis.state.house_angle, 0.5 * acceleration * t * t, 1e-12);
  EXPECT_NEAR(read(axis.model, axis.state).shaft_speed[0], acceleration * t * kRatio, 1e-9);
  EXPECT_NEAR(read(axis.model, axis.state).shaft_position[0], 0.5 * acceleration * t * t * kRatio, 1e-9);
  // What the gears pass on moves the 12 kg m^2 alone.
  EXPECT_NEAR(axis.state.gear_torque[0], kInertia * acceleration, 1e-9);
  EXPECT_NEAR(mechanical_energy(axis.model, axis.state), axis.state.supplied_work, 1e-9 * axis.state.supplied_work);
}

// Dry friction: the way to standstill is J w^2 / 2 T, whatever the step, and there it stays under any torque below the level.
TEST(RigidAxis, DryFrictionStopsItWhereItShouldAndHoldsIt) {
  for (const double length : {1e-3, 7e-3}) {
    Simulated axis(rigid_axis(), length);
    start_at(axis, 0.2, 1.3);
    axis.input.friction.house_positive = axis.input.friction.house_negative = 90.0;  // [Nm]
    axis.input.friction.motor[0] = 30.0;
    axis.run(static_cast<int>(0.5 / length));
    const double stop = 0.2 + 0.5 * kTotal * 1.3 * 1.3 / 120.0;
    EXPECT_NEAR(axis.state.house_angle, stop, 1e-13);
    EXPECT_EQ(axis.state.house_speed, 0.0);
    axis.input.motor_torque[0] = 119.0 / kRatio;
    axis.run(1000);
    EXPECT_NEAR(axis.state.house_angle, stop, 1e-13);
    EXPECT_EQ(axis.state.house_speed, 0.0);
    axis.input.motor_torque[0] = -121.0 / kRatio;
    axis.run(1000);
    EXPECT_NEAR(axis.state.house_speed, -1.0 / kTotal * 1000.0 * length, 1e-12);
    // Work done is motion held and heat of friction: the energy left is what work says, less the 1.3 rad/s it began with.
    EXPECT_NEAR(mechanical_energy(axis.model, axis.state) - 0.5 * kTotal * 1.3 * 1.3, axis.state.supplied_work, 1e-9);
  }
}

// A torque against the motion beyond the friction: through zero within a step, with the friction changing sides there.
TEST(RigidAxis, TurnsRoundInsideAStep) {
  Simulated axis(rigid_axis(), 0.01);
  start_at(axis, 0.0, 0.01);
  axis.input.motor_torque[0] = -200.0 / kRatio;
  axis.input.friction.house_positive = axis.input.friction.house_negative = 50.0;
  axis.run(1);
  const double stop = 0.01 * kTotal / 250.0, rest = 0.01 - stop;
  EXPECT_NEAR(axis.state.house_speed, -150.0 / kTotal * rest, 1e-15);
  EXPECT_NEAR(axis.state.house_angle, 0.5 * 0.01 * stop - 0.5 * 150.0 / kTotal * rest * rest, 1e-16);
}

// Gravity turns the axis as a pendulum: hanging at gravity_angle + 90 deg, small swings of sqrt(J / G).
TEST(RigidAxis, GravityMakesItAPendulum) {
  CraneParameters parameters = rigid_axis();
  parameters.axis_force.gravity = 400.0;  // [Nm] at 0 rad
  Simulated axis(parameters);
  const double hanging = 0.5 * std::numbers::pi;
  start_at(axis, hanging - 1e-3, 0.0);
  double before = axis.state.house_angle - hanging;
  std::vector<double> crossings;  // [s]
  for (int k = 1; k < 10000; ++k) {
    axis.run(1);
    const double now = axis.state.house_angle - hanging;
    if (before < 0.0 && now >= 0.0) crossings.push_back((k - now / (now - before)) * kStep);
    before = now;
  }
  ASSERT_GT(crossings.size(), 5u);
  const double period = (crossings.back() - crossings.front()) / static_cast<double>(crossings.size() - 1);
  const double frequency = std::sqrt(400.0 / kTotal);  // [rad/s]
  // Verlet's scheme is fast by (w h)^2 / 24; the swing of 1 mrad adds less than 1e-7.
  const double late = frequency * kStep * frequency * kStep / 24.0;
  EXPECT_NEAR(period, 2.0 * std::numbers::pi / frequency * (1.0 - late), 2e-7);

  // Large swings for 100 s: kinetic energy less the work of gravity, G (sin x - sin x0), stays.
  start_at(axis, 0.0, 0.0);
  double worst = 0.0;
  for (int k = 0; k < 100'000; ++k) {
    axis.run(1);
    const double energy = mechanical_energy(axis.model, axis.state) - 400.0 * std::sin(axis.state.house_angle);
    worst = std::max(worst, std::fabs(energy));
  }
  EXPECT_LT(worst, 1e-5 * 400.0);
}

TEST(RigidAxis, ConstantLoadPullsAlways) {
  CraneParameters parameters = rigid_axis();
  parameters.axis_force.constant = -34.0;  // [Nm]
  Simulated axis(parameters);
  axis.run(1000);
  EXPECT_NEAR(axis.state.house_speed, -34.0 / kTotal, 1e-12);
  axis.input.motor_torque[0] = 34.0 / kRatio;
  axis.run(1000);
  EXPECT_NEAR(axis.state.house_speed, -34.0 / kTotal, 1e-12);
}

// Gravity is held over each step: the error against the reference falls with the square of the step.
TEST(RigidAxis, TheReferenceGoesTheSameWay) {
  CraneParameters parameters = rigid_axis();
  parameters.axis_force = {-20.0, 150.0, 0.4};
  const ReferencePointer reference = make_reference(parameters, {.tolerance = 1e-11});
  const auto torque_at = [](int k) { return 5.0 * std::sin(0.03 * k); };  // [Nm] over 10 ms
  for (int k = 0; k < 300; ++k) advance(*reference, {torque_at(k)}, 0.01 * (k + 1));
  const PlantReadings truth = read(*reference);
  ASSERT_GT(std::fabs(truth.slew_angle), 1.0);
  EXPECT_NEAR(truth.shaft_position[0], kRatio * truth.slew_angle, 1e-9 * truth.shaft_position[0]);
  EXPECT_NEAR(mechanical_energy(*reference), 0.5 * kTotal * std::pow(truth.shaft_speed[0] / kRatio, 2), 1e-9);
  double coarser = 0.0;
  for (const int pieces : {5, 10, 20}) {
    Simulated axis(parameters, 0.01 / pieces);
    for (int k = 0; k < 300; ++k) {
      axis.input.motor_torque[0] = torque_at(k);
      axis.run(pieces);
    }
    const PlantReadings plant = read(axis.model, axis.state);
    const double error = std::fabs(plant.slew_angle - truth.slew_angle);
    EXPECT_LT(error, 1e-6 * truth.slew_angle);
    if (coarser > 0.0) {
      EXPECT_NEAR(coarser / error, 4.0, 0.4);
    }
    coarser = error;
    // Torque through the gears, of the mean acceleration of the last step: the gravity half a step back.
    EXPECT_NEAR(axis.state.gear_torque[0], gear_torques(*reference)[0], 150.0 * truth.shaft_speed[0] / kRatio * 0.01 / pieces);
  }
}

TEST(ElasticAxis, FollowsTheReferenceThroughItsPlay) {
  CraneParameters parameters = elastic_axis();
  parameters.axis_force = {-20.0, 150.0, 0.4};
  Simulated axis(parameters);
  const ReferencePointer reference = make_reference(parameters, {.tolerance = 1e-11});
  double worst_load = 0.0, worst_motor = 0.0, largest = 0.0;
  for (int k = 0; k < 300; ++k) {
    const double torque = 5.0 * std::sin(0.1 * k);  // [Nm]
    axis.input.motor_torque[0] = torque;
    axis.run(10);
    advance(*reference, {torque}, 0.01 * (k + 1));
    const PlantReadings plant = read(axis.model, axis.state), truth = read(*reference);
    worst_load = std::max(worst_load, std::fabs(plant.slew_angle - truth.slew_angle));
    worst_motor = std::max(worst_motor, std::fabs(plant.shaft_speed[0] - truth.shaft_speed[0]) / kRatio);
    largest = std::max(largest, std::fabs(truth.shaft_speed[0]) / kRatio);
  }
  EXPECT_GT(play_crossings(*reference)[0], 3);
  EXPECT_EQ(axis.state.play_crossings[0], play_crossings(*reference)[0]);
  EXPECT_LT(worst_load, 2e-5) << "of " << largest << " rad/s";
  EXPECT_LT(worst_motor, 2e-3 * largest);
}

// The stiffer the transmission, the nearer to one inertia: the motor leads by T_load / k.
TEST(ElasticAxis, TendsToTheRigidOneAsItStiffens) {
  Simulated rigid(rigid_axis());
  double last = 1.0;
  for (const double stiffness : {2e5, 2e6, 2e7, 2e8}) {
    CraneParameters parameters = elastic_axis();
    parameters.drive.gearbox_play = 0.0;
    parameters.drive.gearbox_stiffness = stiffness;
    Simulated elastic(parameters, 1e-4);
    rigid.state = make_plant_state(rigid.model);
    double worst = 0.0;
    for (int k = 0; k < 1000; ++k) {
      rigid.input.motor_torque[0] = elastic.input.motor_torque[0] = 5.0 * std::sin(0.01 * k);
      rigid.run(1);
      elastic.run(10);
      worst = std::max(worst, std::fabs(rigid.state.house_angle - elastic.state.house_angle));
    }
    EXPECT_LT(worst, 0.2 * last) << stiffness;
    last = worst;
  }
  EXPECT_LT(last, 1e-6);
}

TEST(Axis, MassesAndForcesTimesAThousandMoveTheSame) {
  for (const bool is_rigid : {true, false}) {
    CraneParameters small = is_rigid ? rigid_axis() : elastic_axis();
    small.axis_force = {-20.0, 150.0, 0.4};
    CraneParameters large = small;
    constexpr double kFactor = 1024.0;  // a power of two: the same digits
    for (double* number : {&large.drive.motor_inertia, &large.drive.gearbox_stiffness, &large.house.inertia,
                           &large.axis_force.constant, &large.axis_force.gravity}) {
      *number *= kFactor;
    }
    Simulated one(small), other(large);
    for (int k = 0; k < 3000; ++k) {
      one.input.motor_torque[0] = 5.0 * std::sin(0.01 * k);
      other.input.motor_torque[0] = kFactor * one.input.motor_torque[0];
      one.input.friction.house_positive = one.input.friction.house_negative = 10.0;
      other.input.friction.house_positive = other.input.friction.house_negative = 10.0 * kFactor;
      one.run(1);
      other.run(1);
      ASSERT_NEAR(one.state.house_angle, other.state.house_angle, 1e-12) << k;
    }
    EXPECT_GT(std::fabs(one.state.house_angle), 0.01);
  }
}

TEST(Axis, StepsAllocateNothing) {
  for (const CraneParameters& parameters : {rigid_axis(), elastic_axis()}) {
    Simulated axis(parameters);
    axis.input.motor_torque[0] = 5.0;
    axis.input.friction.motor[0] = 1.0;
    const tests::AllocationGuard guard;
    axis.run(1000);
    EXPECT_EQ(guard.count(), 0);
  }
}

TEST(Axis, ARigidDriveGoesWithNeitherBoomNorLoad) {
  CraneParameters axis = rigid_axis();
  axis.load = {.mass = 1.0, .rope_length = 1.0};
  EXPECT_THROW(make_plant_model(axis, kStep), std::invalid_argument);
  EXPECT_THROW(make_reference(axis), std::invalid_argument);
}

}  // namespace
}  // namespace slewlab::sim
