// The reference against closed forms. None of these expectations come from the fixed step or from the
// reference's own modal form: they are oscillators solved by hand, and the exponential of the assembled nodal
// matrices of thesis 3.6.
#include "sim/integrate/reference.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <unsupported/Eigen/MatrixFunctions>

#include "sim/model/boom.h"
#include "sim/model/drive_line.h"
#include "tests/sim/scaled_crane.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::sim {
namespace {

constexpr double kPi = std::numbers::pi;
// [kg m^2] a house that nothing of a crane can move: 1e8 times the boom's inertia.
constexpr double kFixedHouse = 1e16;

class ReferenceTest : public testing::TestWithParam<ReferenceMethod> {
 protected:
  ReferenceOptions options() const { return {.method = GetParam(), .tolerance = 1e-11}; }
};

INSTANTIATE_TEST_SUITE_P(Methods, ReferenceTest, testing::Values(ReferenceMethod::kBdf, ReferenceMethod::kDirk),
                         [](const auto& method) {
                           return method.param == ReferenceMethod::kBdf ? "Bdf" : "Dirk";
                         });

CraneParameters rigid_crane_on_one_group() {
  CraneParameters crane = thesis_crane(0);
  crane.drive.group_count = 1;
  crane.load.mass = 0.0;
  return crane;
}

PlantState state_of(const CraneParameters& crane) { return make_plant_state(make_plant_model(crane, 1e-3)); }

TEST_P(ReferenceTest, PointLoadOnAFixedTipSwingsAsAFreePendulum) {
  CraneParameters crane = thesis_crane(0);
  crane.house.inertia = kFixedHouse;
  crane.load.rod_length = 0.0;
  crane.load.damping_ratio = 0.0;
  const double start_angle = 0.05;  // [rad]
  PlantState state = state_of(crane);
  state.load_q[0] = start_angle * crane.load.rope_length * std::sqrt(crane.load.mass);
  const ReferencePointer reference = make_reference(crane, options());
  set_state(*reference, state, 0.0);
  const double frequency = std::sqrt(kGravity / crane.load.rope_length);  // (2.17)
  for (int k = 1; k <= 8; ++k) {
    const double t = 5.0 * k;
    advance(*reference, {}, t);
    EXPECT_NEAR(rope_angle(*reference), start_angle * std::cos(frequency * t), 1e-8);
  }
}

// The same motion in another size is as hard to follow: what is tolerated is a share of the machine's own motion.
TEST_P(ReferenceTest, TakesAsManyStepsWhateverTheSize) {
  const auto steps = [&](const CraneParameters& crane, double torque, double until) {
    const ReferencePointer reference = make_reference(crane, {.method = GetParam(), .tolerance = 1e-8});
    GroupArray torques{};
    torques.fill(torque);
    advance(*reference, torques, until);
    return static_cast<double>(counts(*reference).steps);
  };
  constexpr double kTorque = 100.0, kUntil = 2.0;  // [Nm] per motor, [s]
  const double thesis = steps(thesis_crane(), kTorque, kUntil);
  for (const double lambda : {1e-4, 1e4}) {
    EXPECT_NEAR(steps(with_lengths_times(thesis_crane(), lambda), kTorque * lambda, kUntil * std::sqrt(lambda)) / thesis, 1.0, 0.05) << lambda;
  }
}

TEST_P(ReferenceTest, TwoMassesOnASpringWithoutPlaySwingAtTheirFrequency) {
  CraneParameters crane = rigid_crane_on_one_group();
  crane.drive.gearbox_play = crane.drive.pinion_play = 0.0;
  crane.drive.gear_damping_ratio = 0.0;
  const double motor = group_inertia(crane.drive), house = driven_inertia(crane);
  const double frequency = std::sqrt(group_stiffness(crane.drive) / series_inertia(motor, house));
  const double speed = 0.01;  // [rad/s] of the motor at the start
  PlantState state = state_of(crane);
  state.motor_speed[0] = speed;
  const ReferencePointer reference = make_reference(crane, options());
  set_state(*reference, state, 0.0);
  const double mean_speed = motor * speed / (motor + house);
  const double amplitude = speed / frequency;
  for (int k = 1; k <= 20; ++k) {
    const double t = 0.137 * k;
    advance(*reference, {}, t);
    EXPECT_NEAR(gear_deflection(*reference, 0), amplitude * std::sin(frequency * t), 1e-8 * amplitude * k);
    const double twist = amplitude * std::sin(frequency * t);
    EXPECT_NEAR(read(*reference).slew_angle, mean_speed * t - motor / (motor + house) * twist, 1e-8 * amplitude * k);
  }
  // Each half period crosses the (empty) play once; t = 0 belongs to no flank.
  EXPECT_EQ(play_crossings(*reference)[0], static_cast<std::int64_t>(std::floor(2.74 * frequency / kPi)));
}

TEST_P(ReferenceTest, UndampedMotorBouncesInItsPlayWithTheClosedFormPeriod) {
  CraneParameters crane = rigid_crane_on_one_group();
  crane.house.inertia = kFixedHouse;
  crane.drive.gear_damping_ratio = 0.0;
  const double speed = 0.004;  // [rad/s]
  const double play = half_play(crane.drive);
  const double frequency = std::sqrt(group_stiffness(crane.drive) / group_inertia(crane.drive));
  // Across the play, half a period in contact, and the same back.
  const double period = 2.0 * (2.0 * play / speed + kPi / frequency);
  PlantState state = state_of(crane);
  state.motor_speed[0] = speed;
  const ReferencePointer reference = make_reference(crane, options());
  set_state(*reference, state, 0.0);
  for (int k = 1; k <= 40; ++k) {
    advance(*reference, {}, k * period);
    EXPECT_NEAR(gear_deflection(*reference, 0), 0.0, 1e-6 * play * k);
    EXPECT_NEAR(read(*reference).shaft_speed[0], speed * total_ratio(crane.drive),
                1e-7 * speed * total_ratio(crane.drive) * k);
  }
  EXPECT_EQ(counts(*reference).contact_changes, 4 * 40);
  EXPECT_EQ(play_crossings(*reference)[0], 2 * 40 - 1);
}

TEST_P(ReferenceTest, DampedImpactEndsWhereTheTeethWouldPullAndGivesBackTheClosedFormSpeed) {
  CraneParameters crane = rigid_crane_on_one_group();
  crane.house.inertia = kFixedHouse;
  crane.drive.gear_damping_ratio = 0.2;
  const double speed = 0.01;  // [rad/s]
  const GearContact gear = gear_contact(crane);
  const double inertia = group_inertia(crane.drive);
  const double frequency = std::sqrt(gear.stiffness / inertia);
  const double ratio = 0.5 * gear.damping / (inertia * frequency);
  const double damped = frequency * std::sqrt(1.0 - ratio * ratio);
  // Depth speed/damped exp(-ratio frequency t) sin(damped t); the torque ends where its second derivative is 0:
  // tan(damped t) = 2 ratio frequency damped / (ratio^2 frequency^2 - damped^2), in the second quadrant.
  const double end =
      std::atan2(2.0 * ratio * frequency * damped, ratio * ratio * frequency * frequency - damped * damped) / damped;
  const double depth = speed / damped * std::exp(-ratio * frequency * end) * std::sin(damped * end);
  const double rebound =
      speed * std::exp(-ratio * frequency * end) *
      (std::cos(damped * end) - ratio * frequency / damped * std::sin(damped * end));
  ASSERT_GT(depth, 0.0);
  ASSERT_LT(rebound, 0.0);

  PlantState state = state_of(crane);
  state.motor_angle[0] = gear.half_play - 0.01 * speed;
  state.motor_speed[0] = speed;
  const ReferencePointer reference = make_reference(crane, options());
  set_state(*reference, state, 0.0);
  advance(*reference, {}, 0.01 + 0.999 * end);
  EXPECT_GT(gear_torques(*reference)[0], 0.0);
  const double later = 0.01;  // [s] in free flight
  advance(*reference, {}, 0.01 + end + later);
  EXPECT_EQ(gear_torques(*reference)[0], 0.0);
  EXPECT_EQ(counts(*reference).contact_changes, 2);
  EXPECT_NEAR(gear_deflection(*reference, 0), gear.half_play + depth + later * rebound, 1e-7 * depth);
  EXPECT_NEAR(read(*reference).shaft_speed[0] / total_ratio(crane.drive), rebound, 1e-8 * speed);
}

TEST_P(ReferenceTest, BoomOnAFixedHouseRingsDownAsAClampedBeam) {
  CraneParameters crane = thesis_crane(16);
  // [kg m^2] 3e6 times the boom's: the frequency stands 2e-7 above the clamped one; the eigenvalue solver loses
  // more than that next to a heavier house.
  crane.house.inertia = 1e14;
  crane.load.mass = 0.0;
  const double frequency = clamped_bending_frequencies(crane.boom)[0];
  const double decay = 0.5 * boom_damping_coefficient(crane.boom) * frequency * frequency;
  const double damped = std::sqrt(frequency * frequency - decay * decay);
  const PlantModel model = make_plant_model(crane, 1e-3);
  PlantState state = make_plant_state(model);
  state.q[1] = 0.5 / model.modes.tip[1];  // 0.5 m at the tip, in the first bending mode
  const ReferencePointer reference = make_reference(crane, options());
  set_state(*reference, state, 0.0);
  for (int k = 1; k <= 20; ++k) {
    const double t = 0.37 * k;
    advance(*reference, {}, t);
    EXPECT_NEAR(tip_displacement(*reference),
                0.5 * std::exp(-decay * t) * (std::cos(damped * t) + decay / damped * std::sin(damped * t)), 5e-6);
  }
}

// All degrees of freedom, both groups on opposite flanks, torque held over 10 ms: between contact changes the
// machine is linear, and the exponential of the nodal matrices gives its motion.
TEST_P(ReferenceTest, WholeCraneInContactFollowsTheExponentialOfTheNodalMatrices) {
  const CraneParameters crane = thesis_crane(6);
  const double hold = 0.01;  // [s]
  const CraneMatrices nodal = assemble_crane(crane, GearState::kClosed);
  const int n = nodal.at.size, groups = nodal.at.group_count;
  // State [u, u'] and the groups' torques as constant states.
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(2 * n + groups, 2 * n + groups);
  const Eigen::PartialPivLU<Eigen::MatrixXd> mass(nodal.mass);
  system.block(0, n, n, n).setIdentity();
  system.block(n, 0, n, n) = -mass.solve(nodal.stiffness);
  system.block(n, n, n, n) = -mass.solve(nodal.damping);
  system.block(n, 2 * n, n, groups) = mass.solve(Eigen::MatrixXd::Identity(n, n)).leftCols(groups);
  const Eigen::MatrixXd over_hold = (system * hold).exp();

  const GearContact gear = gear_contact(crane);
  const double per_motor = crane.drive.motors_per_group * total_ratio(crane.drive);
  const double preload = 200.0;  // [Nm] per motor, groups against each other
  PlantState start = state_of(crane);
  for (int i = 0; i < 2; ++i) {
    const double side = i == 0 ? 1.0 : -1.0;
    start.motor_angle[i] = side * (gear.half_play + preload * per_motor / gear.stiffness);
  }
  const ReferencePointer reference = make_reference(crane, options());
  set_state(*reference, start, 0.0);
  Eigen::VectorXd deviation = Eigen::VectorXd::Zero(2 * n + groups);
  for (int k = 0; k < 200; ++k) {
    const double common = k < 20 ? 30.0 : 50.0 * std::sin(0.05 * k);  // [Nm] per motor
    deviation.tail(groups).setConstant(common * per_motor);
    deviation = (over_hold * deviation).eval();
    advance(*reference, {common + preload, common - preload}, (k + 1) * hold);
    const double twist = deviation(0) - deviation(nodal.at.house);
    const double twist_rate = deviation(n) - deviation(n + nodal.at.house);
    ASSERT_NEAR(read(*reference).slew_angle, deviation(nodal.at.house), 1e-10);
    ASSERT_NEAR(tip_displacement(*reference), deviation(nodal.at.tip), 3e-9);
    ASSERT_NEAR(rope_angle(*reference), deviation(nodal.at.rope), 1e-10);
    ASSERT_NEAR(rod_angle(*reference), deviation(nodal.at.rod), 1e-9);
    ASSERT_NEAR(gear_torques(*reference)[0],
                preload * per_motor + gear.stiffness * twist + gear.damping * twist_rate,
                1e-6 * preload * per_motor);
    ASSERT_NEAR(read(*reference).tip_acceleration, (system * deviation)(n + nodal.at.tip), 1e-5);
  }
  EXPECT_EQ(counts(*reference).contact_changes, 0);
}

TEST_P(ReferenceTest, UnevenGroupsShareTheTorqueByTheirInertia) {
  ReferenceMachine machine = reference_machine(rigid_crane_on_one_group());
  machine.crane.drive.group_count = 2;
  machine.gear.fill(gear_contact(thesis_crane(0)));
  machine.gear[1].stiffness *= 0.8;
  machine.gear[1].half_play *= 3.0;
  machine.group_inertia[1] *= 1.5;
  machine.group_inertia[0] = group_inertia(machine.crane.drive);
  const ReferencePointer reference = make_reference(machine, options());
  const double torque = 30.0;  // [Nm] per motor
  advance(*reference, {torque, torque}, 150.0);
  const double per_group = torque * machine.crane.drive.motors_per_group * total_ratio(machine.crane.drive);
  // Long after the swings have died all turn with one acceleration.
  const double acceleration =
      2.0 * per_group / (machine.group_inertia[0] + machine.group_inertia[1] + driven_inertia(machine.crane));
  for (int i = 0; i < 2; ++i) {
    const double gear_torque = per_group - machine.group_inertia[i] * acceleration;
    EXPECT_NEAR(gear_torques(*reference)[i], gear_torque, 1e-6 * per_group);
    EXPECT_NEAR(gear_deflection(*reference, i),
                machine.gear[i].half_play + gear_torque / machine.gear[i].stiffness, 1e-10);
  }
  EXPECT_NEAR(read(*reference).pivot_acceleration, machine.crane.boom.pivot_radius * acceleration, 1e-8);
}

TEST_P(ReferenceTest, ExtraWithAStateActsAsATorqueThatLags) {
  CraneParameters crane = rigid_crane_on_one_group();
  crane.drive.gearbox_play = 1.0;  // [rad] so wide that the motor runs free
  const double time_constant = 0.05;  // [s] of the drive
  ReferenceExtra lag;
  lag.start = {0.0};
  lag.scale = {1e5};  // [Nm]
  lag.forces = [&](const ReferenceMotion& motion, const double* state, ReferenceForces& forces, double* rate) {
    rate[0] = (motion.motor_torque[0] - state[0]) / time_constant;
    forces.motor_torque[0] = state[0] - motion.motor_torque[0];
  };
  const ReferencePointer reference = make_reference(reference_machine(crane), options(), lag);
  const double torque = 10.0;  // [Nm] per motor
  const double held = torque * crane.drive.motors_per_group * total_ratio(crane.drive);
  advance(*reference, {torque}, 0.1);
  const double first = 1.0 - std::exp(-0.1 / time_constant);
  EXPECT_NEAR(extra_states(*reference)[0], held * first, 1e-6 * held);
  // The motor's speed is the integral of the lagging torque; the torque then ends and dies away.
  const double speed = held / group_inertia(crane.drive) * (0.1 - time_constant * first);
  EXPECT_NEAR(read(*reference).shaft_speed[0], speed * total_ratio(crane.drive), 1e-7);
  advance(*reference, {}, 3.0);
  const double end = speed + held / group_inertia(crane.drive) * first * time_constant;
  EXPECT_NEAR(read(*reference).shaft_speed[0], end * total_ratio(crane.drive), 1e-6);
}

TEST_P(ReferenceTest, ExtraForcesReachHouseTipAndLoad) {
  // House against a viscous bearing; the load's rod and a fixed force on it, at rest against gravity.
  CraneParameters crane = thesis_crane(0);
  crane.house.inertia = kFixedHouse;
  crane.load.damping_ratio = 0.3;
  ReferenceExtra extra;
  const double side_force = 1000.0;  // [N] on the rope's lower end
  const double moment = 500.0;       // [Nm] on the rod
  extra.forces = [&](const ReferenceMotion&, const double*, ReferenceForces& forces, double*) {
    forces.load_force = side_force;
    forces.rod_moment = moment;
  };
  const ReferencePointer reference = make_reference(reference_machine(crane), options(), extra);
  advance(*reference, {}, 200.0);
  // (3.19): M g on the rope, M g L_l / 2 on the rod.
  EXPECT_NEAR(rope_angle(*reference), side_force / (crane.load.mass * kGravity), 1e-8);
  EXPECT_NEAR(rod_angle(*reference), moment / (0.5 * crane.load.mass * kGravity * crane.load.rod_length), 1e-8);

  CraneParameters slewing = rigid_crane_on_one_group();
  slewing.drive.gearbox_play = 10.0;  // [rad] so wide that the house turns free
  const double inertia = driven_inertia(slewing);
  const double drag = 0.5 * inertia;  // [Nms/rad]
  ReferenceExtra bearing;
  bearing.forces = [&](const ReferenceMotion& motion, const double*, ReferenceForces& forces, double*) {
    forces.house_torque = -drag * motion.house_speed;
    forces.tip_force = 100.0 / tip_radius(slewing.boom);  // together 100 Nm about the slew axis
  };
  const ReferencePointer turning = make_reference(reference_machine(slewing), options(), bearing);
  PlantState state = state_of(slewing);
  state.v[0] = 0.02 * std::sqrt(inertia);  // 0.02 rad/s
  set_state(*turning, state, 0.0);
  const double final_speed = 100.0 / drag;
  for (const double t : {1.0, 3.0, 7.0}) {
    advance(*turning, {}, t);
    const double gone = 1.0 - std::exp(-0.5 * t);
    EXPECT_NEAR(read(*turning).slew_angle, final_speed * t + (0.02 - final_speed) * gone / 0.5, 1e-9);
  }
}

TEST_P(ReferenceTest, LoadHangsStillFromTheStartUnderSteadyForcesAndASpring) {
  CraneParameters crane = thesis_crane(0);
  crane.house.inertia = kFixedHouse;
  crane.load.damping_ratio = 0.0;  // a swing would stay
  ReferenceExtra extra;
  const double side_force = 1000.0, spring = 2000.0;  // [N], [N/m] on the rope's lower end
  const double moment = 500.0;                        // [Nm] on the rod
  extra.forces = [&](const ReferenceMotion& motion, const double*, ReferenceForces& forces, double*) {
    forces.load_force = side_force - spring * motion.rope_end_displacement;
    forces.rod_moment = moment;
  };
  const ReferencePointer reference = make_reference(reference_machine(crane), options(), extra);
  hang_load(*reference);
  // (3.19), and the spring beside M g / L_wr; the boom then gives by what the rope pulls.
  const double rope = crane.load.mass * kGravity / crane.load.rope_length;
  EXPECT_NEAR(rope_angle(*reference), side_force / (rope + spring) / crane.load.rope_length, 1e-12);
  const double rod = moment / (0.5 * crane.load.mass * kGravity * crane.load.rod_length);
  EXPECT_NEAR(rod_angle(*reference), rod, 1e-12);

  CraneParameters stiff = crane;
  stiff.boom.youngs_modulus *= 1e6;
  const ReferencePointer still = make_reference(reference_machine(stiff), options(), extra);
  hang_load(*still);
  advance(*still, {}, 7.0);
  EXPECT_NEAR(rod_angle(*still), rod, 1e-6);
  EXPECT_NEAR(rope_angle(*still), side_force / (rope + spring) / stiff.load.rope_length, 1e-6);
}

TEST_P(ReferenceTest, GearOffsetMovesTheFlankAndSofterGearsGiveMore) {
  CraneParameters crane = rigid_crane_on_one_group();
  crane.house.inertia = kFixedHouse;
  ReferenceMachine machine = reference_machine(crane);
  machine.gear[0].damping = 0.3 * std::sqrt(machine.gear[0].stiffness * machine.group_inertia[0]);
  const double offset = 3e-5;  // [rad]
  ReferenceExtra extra;
  extra.gears = [&](const ReferenceMotion&, const double*, ReferenceGears& gears) {
    gears.stiffness_share[0] = 0.9;
    gears.offset[0] = offset;
  };
  const ReferencePointer reference = make_reference(machine, options(), extra);
  advance(*reference, {50.0}, 30.0);
  const double torque = 50.0 * crane.drive.motors_per_group * total_ratio(crane.drive);
  EXPECT_NEAR(gear_torques(*reference)[0], torque, 1e-6 * torque);
  EXPECT_NEAR(gear_deflection(*reference, 0),
              machine.gear[0].half_play - offset + torque / (0.9 * machine.gear[0].stiffness), 1e-11);
}

TEST_P(ReferenceTest, KeepsEnergyWithoutDampingWhileThePlayIsCrossed) {
  CraneParameters crane = thesis_crane(6);
  crane.drive.gear_damping_ratio = crane.boom.damping_ratio = crane.load.damping_ratio = 0.0;
  PlantState state = state_of(crane);
  state.motor_speed[0] = 0.01;
  state.motor_speed[1] = -0.004;
  const ReferencePointer reference = make_reference(crane, options());
  set_state(*reference, state, 0.0);
  const double start = mechanical_energy(*reference);
  for (int k = 1; k <= 100; ++k) {
    advance(*reference, {}, 0.05 * k);
    ASSERT_NEAR(mechanical_energy(*reference), start, 2e-7 * start);
  }
  EXPECT_GT(play_crossings(*reference)[0], 5);
}

TEST(ReferenceErrors, RefusesWhatCannotBe) {
  CraneParameters crane = thesis_crane(2);
  EXPECT_THROW(make_reference(crane, {.method = ReferenceMethod::kBdf, .tolerance = 0.0}), std::invalid_argument);
  ReferenceExtra extra;
  extra.start = {0.0};
  EXPECT_THROW(make_reference(reference_machine(crane), {}, extra), std::invalid_argument);
  const ReferencePointer reference = make_reference(crane);
  advance(*reference, {}, 1.0);
  EXPECT_THROW(advance(*reference, {}, 0.5), std::invalid_argument);
  EXPECT_THROW(set_state(*reference, PlantState{}, 0.0), std::invalid_argument);
  crane.drive.group_count = 9;
  EXPECT_THROW(make_reference(crane), std::invalid_argument);
  ReferenceMachine machine = reference_machine(thesis_crane(2));
  machine.group_inertia[1] = 0.0;
  EXPECT_THROW(make_reference(machine, {}), std::invalid_argument);
}

}  // namespace
}  // namespace slewlab::sim
