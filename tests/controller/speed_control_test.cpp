#include "controller/speed_control.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

namespace slewlab::controller {
namespace {

constexpr double kInertia = 100.0;   // [kg m^2] on the fast axis, about what one motor of six drags along
constexpr double kGain = 40.0;       // [N m s/rad]
constexpr double kRated = 400.0;     // [N m]
constexpr double kNoLimit = 1e9;     // [N m]

SpeedControlSettings settings() { return {kGain, 1.0, 0.0}; }

// Speed of J dw/dt = T under PI after a unit step of the reference. With T = Kp e + Kp/Ti int e the closed
// loop is (Kp s + Kp/Ti) / (J s^2 + Kp s + Kp/Ti): two poles p1, p2 and
//   w(t) = 1 - [ (J p1) e^(p1 t) - (J p2) e^(p2 t) ] / (J (p1 - p2)).
double closed_form(double time) {
  const std::complex<double> root = std::sqrt(std::complex<double>(kGain * kGain - 4.0 * kInertia * kGain, 0.0));
  const std::complex<double> p1 = (-kGain + root) / (2.0 * kInertia);
  const std::complex<double> p2 = (-kGain - root) / (2.0 * kInertia);
  const std::complex<double> error = (p1 * std::exp(p1 * time) - p2 * std::exp(p2 * time)) / (p1 - p2);
  return 1.0 - error.real();
}

double simulated_error(double period) {
  SpeedControlState state;
  double speed = 0.0;
  double worst = 0.0;
  for (int i = 0; i * period < 20.0; ++i) {
    worst = std::max(worst, std::abs(speed - closed_form(i * period)));
    const double torque = step_speed_control(settings(), state, period, 1.0 - speed, kRated, kNoLimit).torque;
    speed += period * torque / kInertia;  // exact: the torque is held over the period
  }
  return worst;
}

TEST(SpeedControl, StepResponseIsThatOfTheContinuousLoop) {
  // The hold delays the torque by half a period on average: the error is of first order in the period.
  const double at_one = simulated_error(1e-3);
  EXPECT_LT(at_one, 1e-3);
  EXPECT_NEAR(simulated_error(2e-3) / at_one, 2.0, 0.1);
  for (const double period : {5e-3, 10e-3, 20e-3}) EXPECT_LT(simulated_error(period), period) << period;
}

TEST(SpeedControl, ProportionalAloneGivesAFirstOrderLoop) {
  const SpeedControlSettings proportional{kGain, 1e12, 0.0};
  SpeedControlState state;
  double speed = 0.0;
  const double period = 1e-4;
  for (int i = 0; i < 25000; ++i) {
    speed += period * step_speed_control(proportional, state, period, 1.0 - speed, kRated, kNoLimit).torque / kInertia;
  }
  EXPECT_NEAR(speed, 1.0 - std::exp(-kGain / kInertia * 2.5), 1e-4);
}

TEST(SpeedControl, IntegralOfAConstantErrorIsExactForEveryPeriod) {
  for (const double period : {1e-3, 2e-3, 5e-3, 10e-3, 20e-3}) {
    SpeedControlState state;
    const int steps = static_cast<int>(std::lround(1.0 / period));
    state.error = 2.0;  // the error was there before
    for (int i = 0; i < steps; ++i) step_speed_control(settings(), state, period, 2.0, kRated, kNoLimit);
    EXPECT_NEAR(state.integral_torque, kGain / 1.0 * 2.0 * 1.0, 1e-9) << period;
  }
}

TEST(SpeedControl, TorqueNeverPassesTheLimit) {
  SpeedControlState state;
  for (int i = 0; i < 1000; ++i) {
    const double error = 1000.0 * std::sin(0.01 * i);
    EXPECT_LE(std::abs(step_speed_control(settings(), state, 0.01, error, kRated, kRated).torque), kRated);
  }
}

// Ten seconds at the limit: without anti-windup the integral would stand at 40 * 20 * 10 = 8000 N m and hold
// the torque at the limit long after the error turned. With it the torque leaves the limit at once.
TEST(SpeedControl, IntegralDoesNotWindUpAtTheLimit) {
  SpeedControlState state;
  for (int i = 0; i < 1000; ++i) step_speed_control(settings(), state, 0.01, 20.0, kRated, kRated);
  EXPECT_LE(state.integral_torque, kRated);
  const SpeedControlOutput turned = step_speed_control(settings(), state, 0.01, -1.0, kRated, kRated);
  EXPECT_LT(turned.torque, kRated);
}

TEST(SpeedControl, IntegralMayLeaveTheLimitInward) {
  SpeedControlState state;
  state.integral_torque = 390.0;
  state.error = -1.0;
  // Still at the limit through the proportional part, but the error has turned: the integral goes down.
  step_speed_control(settings(), state, 0.01, -0.1, kRated, 300.0);
  EXPECT_LT(state.integral_torque, 390.0);
}

// Droop is static: with a constant torque T the speed stands droop * T / T100 below the reference.
TEST(SpeedControl, DroopLowersTheSpeedByItsShareOfTheTorque) {
  const SpeedControlSettings drooping{kGain, 1.0, 3.0};
  SpeedControlState state;
  const double load = 200.0;  // [N m], half of rated
  double speed = 50.0;
  for (int i = 0; i < 60000; ++i) {
    const double torque = step_speed_control(drooping, state, 1e-3, 50.0 - speed, kRated, kNoLimit).torque;
    speed += 1e-3 * (torque - load) / kInertia;
  }
  EXPECT_NEAR(speed, 50.0 - 3.0 * 0.5, 1e-6);
}

TEST(SpeedControl, NoDroopLeavesNoError) {
  SpeedControlState state;
  double speed = 50.0;
  for (int i = 0; i < 120000; ++i) {  // 24 time constants of the slower pole
    const double torque = step_speed_control(settings(), state, 1e-3, 50.0 - speed, kRated, kNoLimit).torque;
    speed += 1e-3 * (torque - 200.0) / kInertia;
  }
  EXPECT_NEAR(speed, 50.0, 1e-6);
}

}  // namespace
}  // namespace slewlab::controller
