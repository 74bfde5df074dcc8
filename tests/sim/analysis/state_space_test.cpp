#include "sim/analysis/state_space.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <numbers>

#include "sim/analysis/bode.h"
#include "sim/model/drive_line.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::sim {
namespace {

using Complex = std::complex<double>;

// Index of an output by its name; -1 where there is none.
int output(const StateSpace& system, const std::string& name) {
  for (std::size_t i = 0; i < system.outputs.size(); ++i) {
    if (system.outputs[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

// C (iw - A)^-1 B + D, the same torque on every motor.
Complex response(const StateSpace& system, const std::string& name, double frequency) {
  const Complex iw(0.0, 2.0 * std::numbers::pi * frequency);
  const Eigen::MatrixXcd dynamic = iw * Eigen::MatrixXcd::Identity(system.a.rows(), system.a.rows()) - system.a.cast<Complex>();
  const Eigen::VectorXcd one = Eigen::VectorXcd::Ones(system.b.cols());
  const Eigen::VectorXcd states = dynamic.partialPivLu().solve(system.b.cast<Complex>() * one);
  const int row = output(system, name);
  return (system.c.row(row).cast<Complex>() * states)(0) + (system.d.row(row).cast<Complex>() * one)(0);
}

// The matrices of second order, solved at each frequency by bode.cpp, have no part in A, B, C, D.
TEST(StateSpace, HasTheResponseOfTheMatrices) {
  for (const int elements : {0, 6}) {
    const CraneParameters crane = thesis_crane(elements);
    const StateSpace system = state_space(crane);
    for (const double frequency : {0.2, 1.31, 5.0, 20.0}) {
      const Complex velocity = frequency_response(crane, {frequency})[0].tip_velocity;
      EXPECT_LT(std::abs(response(system, "tip_velocity", frequency) / velocity - 1.0), 1e-8) << elements << " " << frequency;
      const Complex acceleration = Complex(0.0, 2.0 * std::numbers::pi * frequency) * velocity;
      EXPECT_LT(std::abs(response(system, "tip_acceleration", frequency) / acceleration - 1.0), 1e-8) << elements << " " << frequency;
    }
  }
}

// Gears open, the motors turn alone: speed = torque / (i w J), J of motor, brake and gearbox on the fast axis.
TEST(StateSpace, WithOpenGearsTheMotorsTurnAlone) {
  const CraneParameters crane = thesis_crane();
  const StateSpace system = state_space(crane, GearState::kOpen);
  const Complex exact = 1.0 / (Complex(0.0, 2.0 * std::numbers::pi) * drive_inertia(crane.drive));
  EXPECT_LT(std::abs(response(system, "shaft_speed_1", 1.0) / exact - 1.0), 1e-9);
}

TEST(StateSpace, ARigidAxisIsOneInertia) {
  CraneParameters axis;
  axis.drive = {.group_count = 1, .motors_per_group = 1, .motor_inertia = 0.01, .gearbox_ratio = 20.0, .is_rigid = true};
  axis.house.inertia = 6.0;
  axis.boom.element_count = 0;
  const StateSpace system = state_space(axis);
  ASSERT_EQ(system.a.rows(), 2);
  EXPECT_EQ(system.states[0].name, "house");
  EXPECT_NEAR(system.b(1, 0), 20.0 / (6.0 + 0.01 * 20.0 * 20.0), 1e-12);  // ratio / (load + motor * ratio^2)
  EXPECT_EQ(output(system, "tip_velocity"), -1);
}

TEST(StateSpace, EverySignalIsNamed) {
  const StateSpace system = state_space(thesis_crane(2));
  EXPECT_EQ(system.states.size(), static_cast<std::size_t>(system.a.rows()));
  EXPECT_EQ(system.outputs.size(), static_cast<std::size_t>(system.c.rows()));
  // Two groups, house, two nodes with three coordinates each, rope and rod; then their rates.
  ASSERT_EQ(system.states.size(), 22u);
  EXPECT_EQ(system.states[2].name, "house");
  EXPECT_EQ(system.states[8].name, "boom_twist_2");
  EXPECT_EQ(system.states[10].name, "rod_angle");
  EXPECT_EQ(system.states[19].unit, "rad/s");
}

}  // namespace
}  // namespace slewlab::sim
