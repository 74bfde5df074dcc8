// Hoisting, luffing and travelling: closed forms, one law for effect and scenario, and the reference, whose motion changes continuously.
#include "sim/integrate/crane_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "sim/integrate/crane_motion_reference.h"
#include "sim/integrate/machine.h"
#include "sim/model/boom.h"
#include "sim/model/drive_line.h"
#include "tests/common/allocation_guard.h"
#include "tests/sim/a_frame_crane.h"
#include "tests/sim/effects/effect_bench.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::sim {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;  // [rad]
constexpr double kStep = 1e-3;                        // [s]

std::int64_t nanoseconds(double seconds) { return std::llround(seconds * 1e9); }

MotionParameters motions() {
  return {.hoisting = {0.5, 0.75}, .shortest_rope = 5.0, .luffing = {1.0 * kDegree, 0.5 * kDegree}, .lowest_angle = 0.2, .highest_angle = 1.5,
          .travelling = {0.5, 0.1}, .travel_direction = 90.0 * kDegree};
}

struct Swing {
  double displacement, velocity;  // [m], [m/s] of the load against the sheave
};

Swing swing_of(const Machine& machine) {
  const PlantState& state = machine.state;
  const Eigen::Matrix2d& modes = machine.model.load.modes;
  return {modes(0, 0) * state.load_q[0] + modes(0, 1) * state.load_q[1] - state.tip_displacement,
          modes(0, 0) * state.load_v[0] + modes(0, 1) * state.load_v[1] - state.tip_velocity};
}

void hang_at(Machine& machine, double angle) {
  const PlantModel& model = machine.model;
  const Eigen::Vector2d place(angle * model.parameters.load.rope_length, angle);
  const Eigen::Vector2d q = model.load.modes.transpose() * (model.load.mass * place);
  machine.state.load_q = {q(0), q(1)};
  refresh(model, machine.state);
}

Machine moving(CraneParameters crane, const MotionRequests& requests, int steps_per_boom_angle = 10) {
  crane.motions = motions();
  MachineSettings settings{.crane = crane, .effects = {}, .step = kStep};
  settings.motion_requests = requests;
  settings.steps_per_boom_angle = steps_per_boom_angle;
  return make_machine(settings);
}

void run_until(Machine& machine, double time) {
  while (time_of(machine) < time - 0.5 * kStep) step(machine, {});
}

// At a constant hoisting speed v the pendulum L b'' - 2 v b' + g b = 0 has the solutions Z_1(u) / u with u = 2 sqrt(g L) / v (Bessel's
// functions, textbook). Their two factors are read off at one moment, and foretell the angle 50 s and 25 m of rope later.
TEST(CraneMotion, HoistingAtConstantSpeedIsBessels) {
  Machine machine = moving(pendulum(), {.hoisting = {{0, 1.0}}, .luffing = {}, .travelling = {}});
  hang_at(machine, 0.02);
  const double v = 0.5, begin = 5.0, end = 55.0;
  const auto u_at = [&](double time) { return 2.0 * std::sqrt(kGravity * rope_length(machine.motion, time)) / v; };
  const auto first = [](double u) { return std::cyl_bessel_j(1, u) / u; };
  const auto second = [](double u) { return std::cyl_neumann(1, u) / u; };
  // d/du (Z_1 / u) = -Z_2 / u, and du/dt = -g / sqrt(g L).
  const auto first_rate = [](double u) { return -std::cyl_bessel_j(2, u) / u; };
  const auto second_rate = [](double u) { return -std::cyl_neumann(2, u) / u; };
  run_until(machine, begin);
  const double length = rope_length(machine.motion, begin);
  const Swing swing = swing_of(machine);
  const double angle = swing.displacement / length, rate = (swing.velocity + v * angle) / length;
  const double u = u_at(begin), u_rate = -kGravity / std::sqrt(kGravity * length);
  Eigen::Matrix2d system;
  system << first(u), second(u), first_rate(u) * u_rate, second_rate(u) * u_rate;
  const double determinant = system(0, 0) * system(1, 1) - system(0, 1) * system(1, 0);
  const double a = (system(1, 1) * angle - system(0, 1) * rate) / determinant, b = (system(0, 0) * rate - system(1, 0) * angle) / determinant;
  double largest = 0.0;
  while (time_of(machine) < end) {
    step(machine, {});
    const double now = u_at(time_of(machine));
    largest = std::max(largest, std::fabs(rope_angle(machine) - (a * first(now) + b * second(now))));
  }
  EXPECT_LT(largest / 0.02, 2e-5);
  EXPECT_GT(largest, 0.0);
}

// Hoisted slowly, the swing keeps its energy per frequency: the angle grows as L^(-3/4).
TEST(CraneMotion, ASlowHoistKeepsTheAdiabaticInvariant) {
  Machine machine = moving(pendulum(), {.hoisting = {{0, 0.2}, {nanoseconds(300.0), 0.0}}, .luffing = {}, .travelling = {}});
  hang_at(machine, 0.01);
  run_until(machine, 310.0);
  const double length = rope_length(machine.motion, 310.0);
  EXPECT_NEAR(length, 30.0, 1e-9);
  double largest = 0.0;
  while (time_of(machine) < 330.0) {
    step(machine, {});
    largest = std::max(largest, std::fabs(rope_angle(machine)));
  }
  // The invariant is kept but for the first order beyond it, L' / (2 w L) at the end, 0.3 %.
  const double beyond = 0.1 / (2.0 * std::sqrt(kGravity / 30.0) * 30.0);
  EXPECT_NEAR(largest / 0.01 / std::pow(30.0 / 60.0, -0.75), 1.0, beyond);
}

// The effect and the scenario's hoist are one law: with one and the same course of the winch they give one swing, rod and boom included.
TEST(CraneMotion, HoistsAsTheEffectDoes) {
  CraneParameters crane = thesis_crane();
  crane.motions = motions();  // 0.5 m/s within 1 s
  crane.drive.gearbox_play = crane.drive.pinion_play = 0.0;  // the two ramps are rounded otherwise, which grows wherever teeth strike
  MachineSettings with_effect{.crane = crane, .effects = {{"hoisting", {0.5, 2.0, 20.0, 1.0, 1.0}}}, .step = kStep};
  MachineSettings with_move{.crane = crane, .effects = {}, .step = kStep};
  with_move.motion_requests.hoisting = {{nanoseconds(2.0), 1.0}, {nanoseconds(21.0), 0.0}};
  Machine effect = make_machine(with_effect), move = make_machine(with_move);
  hang_at(effect, 0.03);
  hang_at(move, 0.03);
  double largest = 0.0;
  for (int k = 0; k < 30000; ++k) {
    step(effect, {});
    step(move, {});
    largest = std::max(largest, std::fabs(swing_of(effect).displacement - swing_of(move).displacement));
  }
  EXPECT_LT(largest, 1e-10);
  EXPECT_NEAR(rope_length(move.motion, 30.0), 60.0 - 9.5, 1e-9);
}

// The ramp's acceleration is a parabola, so that the load's swing is x = -(a - a'' / w^2) / w^2 + the free swing that begins at rest, exactly.
// Its middle is the a / g of a steady acceleration.
TEST(CraneMotion, TravellingSwingsTheLoad) {
  CraneParameters crane = pendulum();
  crane.motions = motions();
  crane.motions.travelling = {1.0, 0.01};  // a ramp of 150 s
  MachineSettings settings{.crane = crane, .effects = {}, .step = kStep};
  settings.motion_requests.travelling = {{0, 1.0}};
  Machine machine = make_machine(settings);
  const double w = std::sqrt(kGravity / 60.0), ramp = 150.0;
  const double bend = -12.0 / (ramp * ramp * ramp), slope = 6.0 / (ramp * ramp);  // a'' and a'(0)
  double largest = 0.0;
  while (time_of(machine) < 140.0) {
    step(machine, {});
    const double t = time_of(machine), a = 6.0 * t / ramp * (1.0 - t / ramp) / ramp;
    const double exact = -(a - bend / (w * w)) / (w * w) - bend / (w * w * w * w) * std::cos(w * t) + slope / (w * w * w) * std::sin(w * t);
    largest = std::max(largest, std::fabs(swing_of(machine).displacement - exact));
    if (std::fabs(t - 75.0) < 0.5 * kStep) {
      EXPECT_NEAR(exact / 60.0, -0.01 / kGravity, 1e-4 * 0.01 + slope / (w * w * w) / 60.0);
    }
  }
  EXPECT_LT(largest, 1e-6);
}

// The accelerometers of a crane that stands on what travels read the base's acceleration across the boom, along the boom's part nothing.
TEST(CraneMotion, AccelerometersReadTheBase) {
  CraneParameters crane = pendulum();
  crane.load = {};
  Machine machine = moving(crane, {.hoisting = {}, .luffing = {}, .travelling = {{0, 1.0}}});
  run_until(machine, 3.75);  // the ramp's middle: 1.5 * 0.5 / 0.1 = 7.5 s
  const PlantReadings readings = read(machine);
  EXPECT_NEAR(readings.house_acceleration, 0.1, 1e-7);
  EXPECT_NEAR(readings.tip_acceleration, 0.1, 1e-7);
}

// Slewing freely, the crane keeps its angular momentum while its boom luffs by 20 degrees and its inertia falls by half.
TEST(CraneMotion, LuffingKeepsAngularMomentum) {
  CraneParameters crane = thesis_crane(0);
  crane.load = {};
  Machine machine = moving(crane, {.hoisting = {}, .luffing = {{0, 1.0}, {nanoseconds(18.0), 0.0}}, .travelling = {}});
  const double speed = 0.03;  // [rad/s]
  machine.state.v[0] = speed / machine.model.house[0];
  machine.state.motor_speed.fill(speed);
  refresh(machine.model, machine.state);
  const auto momentum = [&] {
    double sum = machine.state.house_speed * machine.motion.basis.inertia;
    for (int i = 0; i < machine.model.group_count; ++i) sum += machine.model.group_inertia[i] * machine.state.motor_speed[i];
    return sum;
  };
  const double at_start = momentum(), inertia = machine.motion.basis.inertia;
  run_until(machine, 25.0);
  EXPECT_NEAR(machine.motion.basis.angle, (53.5 + 18.0) * kDegree, 1e-9);
  EXPECT_LT(machine.motion.basis.inertia, 0.5 * inertia);
  EXPECT_NEAR(momentum() / at_start, 1.0, 1e-6);
  // Faster by the whole inertia's ratio, motors and all; the gears' free vibration is what differs.
  const double motors = machine.model.group_count * machine.model.group_inertia[0];
  EXPECT_NEAR(machine.state.house_speed / speed, (inertia + motors) / (machine.motion.basis.inertia + motors), 0.02);
}

// A bending boom on cylinders, whose hold changes all the while, keeps it too: they stand on the house, and what they do to the boom they do to
// the house. Momentum of house and boom: I house + sum c_j eta_j of the clamped modes.
TEST(CraneMotion, LuffingOnCylindersKeepsAngularMomentum) {
  CraneParameters crane = a_frame_crane();
  crane.load = {};
  Machine machine = moving(crane, {.hoisting = {}, .luffing = {{0, -1.0}, {nanoseconds(18.0), 0.0}}, .travelling = {}});
  const double speed = 0.03;  // [rad/s]
  machine.state.v[0] = speed / machine.model.house[0];
  machine.state.motor_speed.fill(speed);
  refresh(machine.model, machine.state);
  const auto momentum = [&] {
    const LuffedBasis& basis = machine.motion.basis;
    double sum = machine.state.house_speed * basis.inertia;
    for (Eigen::Index k = 0; k < basis.house.size(); ++k) sum += basis.coupling.dot(basis.deflection.col(k)) * machine.state.v[static_cast<std::size_t>(k)];
    for (int i = 0; i < machine.model.group_count; ++i) sum += machine.model.group_inertia[i] * machine.state.motor_speed[i];
    return sum;
  };
  const double at_start = momentum(), inertia = machine.motion.basis.inertia;
  run_until(machine, 25.0);
  EXPECT_GT(machine.motion.basis.inertia, 1.5 * inertia);
  EXPECT_NEAR(momentum() / at_start, 1.0, 1e-6);
}

// At the end of a luff the step goes on with the modes of the boom that stands there: those of a mesh of 128 elements, within half a percent.
TEST(CraneMotion, LuffingOnCylindersEndsInTheModesOfAFineMesh) {
  Machine machine = moving(a_frame_crane(20), {.hoisting = {}, .luffing = {{0, 1.0}, {nanoseconds(20.0), 0.0}}, .travelling = {}});
  const auto expect_the_modes = [&](double angle) {
    const FreeHouseModes modes = free_house_modes(built_at(a_frame_crane(128), angle));
    for (std::size_t k = 1; k <= 4; ++k) EXPECT_NEAR(machine.model.modes.frequency[k] / modes.frequency[k], 1.0, 0.005) << k << " at " << angle;
  };
  expect_the_modes(machine.motion.crane.boom.angle);
  run_until(machine, 25.0);
  expect_the_modes((53.5 + 20.0) * kDegree);
}

// Energy: what motors, ports and luffing gear put in is what is there, but for what damping takes. Without damping nothing is missing. On cylinders too, with a boom
// that swings in bending and torsion while they let go of it.
TEST(CraneMotion, LuffingBooksItsWork) {
  for (CraneParameters crane : {thesis_crane(), a_frame_crane()}) {
    SCOPED_TRACE(crane.boom.cylinders.stiffness > 0.0 ? "on cylinders" : "on ropes");
    crane.boom.damping_ratio = crane.drive.gear_damping_ratio = crane.load.damping_ratio = 0.0;
    Machine machine = moving(crane, {.hoisting = {}, .luffing = {{nanoseconds(1.0), -1.0}, {nanoseconds(10.0), 0.0}}, .travelling = {}});
    DriveCommand command;
    command.motor_torque = {120.0, 120.0};
    const double before = mechanical_energy(machine.model, machine.state);
    for (int k = 0; k < 12000; ++k) step(machine, command);
    const double gained = mechanical_energy(machine.model, machine.state) - before;
    EXPECT_NEAR(machine.state.supplied_work / gained, 1.0, 2e-3);
  }
}

// What effects and accelerometers are told has the luffing's part: on a rigid boom it is what the slewing speed's difference over two steps
// says, but for the gears' vibration within them.
TEST(CraneMotion, AccelerationsHaveTheLuffingsPart) {
  CraneParameters crane = thesis_crane(0);
  crane.load = {};
  Machine machine = moving(crane, {.hoisting = {}, .luffing = {{0, 1.0}}, .travelling = {}});
  const double speed = 0.03;  // [rad/s]
  machine.state.v[0] = speed / machine.model.house[0];
  machine.state.motor_speed.fill(speed);
  refresh(machine.model, machine.state);
  run_until(machine, 8.004);  // amid a stretch of one boom angle
  const double before = machine.state.house_speed;
  step(machine, {});
  const Accelerations now = accelerations(machine.model, machine.state);
  step(machine, {});
  const double luffings = machine.model.per_luffing.house * machine.state.luffing_force;
  EXPECT_GT(std::fabs(luffings), 1e-4);  // [rad/s^2]
  EXPECT_NEAR(now.house, (machine.state.house_speed - before) / (2.0 * kStep), 1e-3 * std::fabs(luffings));
}

// With a boom that bends, at every place: the sum over the modes of shape times acceleration, term by term.
TEST(CraneMotion, AccelerationsAreTheModes) {
  Machine machine = moving(thesis_crane(), {.hoisting = {}, .luffing = {{0, 1.0}}, .travelling = {}});
  DriveCommand command;
  command.motor_torque = {200.0, 150.0};
  for (int k = 0; k < 4005; ++k) step(machine, command);
  const PlantModel& model = machine.model;
  const PlantState& state = machine.state;
  ASSERT_NE(state.luffing_force, 0.0);
  double on_house = state.other_house_torque;
  for (int i = 0; i < model.group_count; ++i) on_house += state.gear_torque[i];
  Accelerations expected;
  double largest = 0.0;  // of the house's part of a mode
  for (std::size_t k = 0; k < static_cast<std::size_t>(model.mode_count); ++k) {
    const double mode = -model.modes.frequency[k] * model.modes.frequency[k] * state.q[k] - model.modes.damping_rate[k] * state.v[k] +
                        model.modes.house[k] * on_house + model.modes.tip[k] * (state.rope_force + state.other_tip_force) +
                        model.luffing[k] * state.luffing_force;
    expected.house += model.modes.house[k] * mode;
    expected.tip += model.modes.tip[k] * mode;
    expected.boom += model.modes.uniform_load[k] * mode;
    expected.pivot += model.modes.pivot[k] * mode;
    expected.middle += model.modes.middle[k] * mode;
    largest = std::max(largest, std::fabs(model.modes.house[k] * mode));
  }
  const Accelerations told = accelerations(model, state);
  const double rounding = 1e-9;  // [-] of sums whose terms are larger than they
  EXPECT_NEAR(told.house, expected.house, rounding * largest);
  EXPECT_NEAR(told.tip, expected.tip, rounding * std::fabs(expected.tip));
  EXPECT_NEAR(told.boom, expected.boom, rounding * std::fabs(expected.boom));
  EXPECT_NEAR(told.pivot, expected.pivot, rounding * largest);
  EXPECT_NEAR(told.middle, expected.middle, rounding * std::fabs(expected.middle));
}

TEST(CraneMotion, NothingIsAllocatedInAStep) {
  for (const CraneParameters& crane : {thesis_crane(), a_frame_crane(20)}) {
    Machine machine = moving(crane, {.hoisting = {{0, 1.0}}, .luffing = {{0, 1.0}}, .travelling = {{0, -1.0}}});
    DriveCommand command;
    command.motor_torque = {200.0, 150.0};
    for (int k = 0; k < 100; ++k) step(machine, command);
    const tests::AllocationGuard guard;
    for (int k = 0; k < 2000; ++k) step(machine, command);
    EXPECT_EQ(guard.count(), 0);
  }
}

// Requests that move nothing leave the bits of a crane that has none.
TEST(CraneMotion, NoMotionIsNoChange) {
  CraneParameters crane = thesis_crane();
  Machine without = make_machine({.crane = crane, .effects = {}, .step = kStep});
  Machine with = moving(crane, {.hoisting = {{0, 0.0}}, .luffing = {{0, 0.0}}, .travelling = {}});
  DriveCommand command;
  command.motor_torque = {200.0, 150.0};
  for (int k = 0; k < 3000; ++k) {
    step(without, command);
    step(with, command);
  }
  EXPECT_EQ(without.state.house_angle, with.state.house_angle);
  EXPECT_EQ(without.state.load_q[0], with.state.load_q[0]);
}

// Largest difference to the reference, as shares of the largest value of each signal.
struct Difference {
  double house_speed, rope_angle, gear_torque;
};

Difference against_reference(const MotionRequests& requests, int steps_per_boom_angle, CraneParameters crane = thesis_crane(3)) {
  crane.motions = motions();
  MachineSettings settings{.crane = crane, .effects = {}, .step = kStep};
  settings.motion_requests = requests;
  settings.steps_per_boom_angle = steps_per_boom_angle;
  Machine machine = make_machine(settings);
  MovingReference moving = moving_reference(crane, requests);
  const ReferencePointer reference = make_reference(std::move(moving.machine), {.tolerance = 1e-8}, std::move(moving.extra));
  Difference error{}, scale{};
  for (int k = 0; k < 1500; ++k) {
    const double time = 1e-2 * k;
    DriveCommand command;
    command.motor_torque = {150.0 * std::min(1.0, time), 120.0 * std::min(1.0, time)};  // on one flank
    for (int i = 0; i < 10; ++i) step(machine, command);
    advance(*reference, command.motor_torque, 1e-2 * (k + 1));
    const double length = rope_length(machine.motion, 1e-2 * (k + 1)) / crane.load.rope_length;
    const auto look = [](double value, double expected, double& difference, double& largest) {
      difference = std::max(difference, std::fabs(value - expected));
      largest = std::max(largest, std::fabs(expected));
    };
    look(rope_angle(machine), rope_angle(*reference) / length, error.rope_angle, scale.rope_angle);
    look(machine.state.gear_torque[0], gear_torques(*reference)[0], error.gear_torque, scale.gear_torque);
    double house_angle = read(*reference).slew_angle;
    look(machine.state.house_angle, house_angle, error.house_speed, scale.house_speed);
  }
  return {error.house_speed / scale.house_speed, error.rope_angle / scale.rope_angle, error.gear_torque / scale.gear_torque};
}

void print(const char* what, const Difference& error) {
  std::printf("%s: slew angle %.2e, rope angle %.2e, gear torque %.2e\n", what, error.house_speed, error.rope_angle, error.gear_torque);
}

TEST(CraneMotion, AgreesWithTheReference) {
  const MotionRequests hoist_and_travel{.hoisting = {{nanoseconds(2.0), 1.0}, {nanoseconds(10.0), -0.5}}, .luffing = {},
                                        .travelling = {{nanoseconds(1.0), 1.0}, {nanoseconds(6.0), 0.0}}};
  const Difference smooth = against_reference(hoist_and_travel, 10);
  print("hoisting and travelling", smooth);
  EXPECT_LT(smooth.house_speed, 1e-5);
  EXPECT_LT(smooth.rope_angle, 1e-4);
  EXPECT_LT(smooth.gear_torque, 1e-3);

  const MotionRequests all{.hoisting = {{nanoseconds(2.0), 1.0}}, .luffing = {{nanoseconds(3.0), -1.0}, {nanoseconds(11.0), 0.0}},
                           .travelling = {{nanoseconds(1.0), 1.0}, {nanoseconds(6.0), 0.0}}};
  const Difference coarse = against_reference(all, 40), usual = against_reference(all, 10);
  print("all three, a boom angle per 40 ms", coarse);
  print("all three, a boom angle per 10 ms", usual);
  EXPECT_LT(usual.house_speed, 1e-4);
  EXPECT_LT(usual.rope_angle, 1e-3);
  EXPECT_LT(usual.gear_torque, 1e-2);
}

// On cylinders: the reference has their hold of every instant as a stiffness on the modes of the start and no solver of eigenvalues.
TEST(CraneMotion, LuffingOnCylindersAgreesWithTheReference) {
  const MotionRequests luff{.hoisting = {}, .luffing = {{nanoseconds(3.0), -1.0}, {nanoseconds(11.0), 0.0}}, .travelling = {}};
  const Difference coarse = against_reference(luff, 40, a_frame_crane(3)), usual = against_reference(luff, 10, a_frame_crane(3));
  print("on cylinders, a boom angle per 40 ms", coarse);
  print("on cylinders, a boom angle per 10 ms", usual);
  EXPECT_LT(usual.house_speed, 1e-6);
  EXPECT_LT(usual.rope_angle, 1e-5);
  EXPECT_LT(usual.gear_torque, 1e-3);
}

}  // namespace
}  // namespace slewlab::sim
