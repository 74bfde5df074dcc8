#include "controller/ramp.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace slewlab::controller {
namespace {

constexpr double kPeriod = 1e-3;  // [s]

RampSettings settings() {
  RampSettings ramp;
  ramp.top_speed = 0.05;
  ramp.acceleration_time = 4.4;
  ramp.deceleration_time = 4.4;
  ramp.emergency_stop_time = 1.5;
  ramp.curved_share = 0.3;
  return ramp;
}

struct Trace {
  std::vector<double> speed;
  std::vector<double> acceleration;
};

// The ramp's answer to a target held for `duration`, starting from `state`.
Trace follow(const RampSettings& ramp, RampState& state, double target, double duration) {
  Trace trace;
  const int steps = static_cast<int>(std::lround(duration / kPeriod));
  for (int i = 0; i <= steps; ++i) {
    step_ramp(ramp, state, kPeriod, target);
    trace.speed.push_back(state.speed);
    trace.acceleration.push_back(state.acceleration);
  }
  return trace;
}

// Time [s] after which the speed no longer changes.
double time_of_change(const Trace& trace) {
  std::size_t last = 0;
  for (std::size_t i = 1; i < trace.speed.size(); ++i) {
    if (trace.speed[i] != trace.speed[i - 1]) last = i;
  }
  return static_cast<double>(last) * kPeriod;
}

double largest(const std::vector<double>& values) { return *std::max_element(values.begin(), values.end()); }

// Trapezoid of acceleration: area = peak * (T - curved end), so peak = 0.05 / (4.4 * 0.7).
TEST(Ramp, SCurveIsATrapezoidOfAcceleration) {
  RampState state;
  const Trace trace = follow(settings(), state, 0.05, 6.0);
  const double peak = 0.05 / (4.4 * 0.7);
  EXPECT_NEAR(largest(trace.acceleration), peak, 1e-15);
  // Half the first curved end: half the peak, speed = acceleration * t / 2.
  EXPECT_NEAR(trace.acceleration[660], 0.5 * peak, 1e-14);
  EXPECT_NEAR(trace.speed[660], 0.5 * peak * 0.66 * 0.5, 1e-15);
  // Half way in time is half way in speed, by symmetry.
  EXPECT_NEAR(trace.speed[2200], 0.025, 1e-14);
  EXPECT_NEAR(trace.acceleration[2200], peak, 1e-15);
  EXPECT_NEAR(time_of_change(trace), 4.4, kPeriod);
  EXPECT_EQ(trace.speed.back(), 0.05);
  EXPECT_EQ(trace.acceleration.back(), 0.0);
}

TEST(Ramp, SpeedIsTheAreaUnderTheAcceleration) {
  RampState state;
  const Trace trace = follow(settings(), state, 0.05, 6.0);
  double area = 0.0;
  for (std::size_t i = 1; i < trace.speed.size(); ++i) {
    area += 0.5 * kPeriod * (trace.acceleration[i] + trace.acceleration[i - 1]);
    ASSERT_NEAR(area, trace.speed[i], 1e-8) << i;  // the trapezoidal rule at the two corners
  }
}

// Thesis 4.5: "half of the maximum speed means half of the duration of acceleration", and the curved parts
// shorten with it, which leaves the peak acceleration as it was.
TEST(Ramp, TimesScaleWithTheSpeedChange) {
  for (const double share : {1.0, 0.5, 0.25, 0.1}) {
    RampState state;
    const Trace trace = follow(settings(), state, 0.05 * share, 6.0);
    const double duration = 4.4 * share;
    EXPECT_NEAR(time_of_change(trace), duration, 1.5 * kPeriod) << share;
    const double peak = 0.05 / (4.4 * 0.7);
    EXPECT_NEAR(largest(trace.acceleration), peak, 1e-14) << share;
    const std::size_t curved_half = static_cast<std::size_t>(std::lround(0.15 * duration / kPeriod));
    EXPECT_NEAR(trace.acceleration[curved_half], 0.5 * peak, 1e-12) << share;
  }
}

TEST(Ramp, DecelerationHasItsOwnTime) {
  RampSettings ramp = settings();
  ramp.deceleration_time = 2.0;
  RampState state;
  follow(ramp, state, 0.05, 5.0);
  EXPECT_NEAR(time_of_change(follow(ramp, state, 0.01, 5.0)), 2.0 * 0.8, 1.5 * kPeriod);
  // Through zero: to zero by the deceleration time, beyond by the acceleration time.
  EXPECT_NEAR(time_of_change(follow(ramp, state, -0.05, 8.0)), 2.0 * 0.2 + 4.4, 1.5 * kPeriod);
  EXPECT_EQ(state.speed, -0.05);
}

TEST(Ramp, LinearHasConstantAcceleration) {
  RampSettings ramp = settings();
  ramp.shape = RampShape::linear;
  RampState state;
  const Trace trace = follow(ramp, state, 0.025, 4.0);
  for (int i = 0; i <= 2200; i += 100) EXPECT_NEAR(trace.speed[i], 0.05 / 4.4 * i * kPeriod, 1e-14);
  EXPECT_NEAR(time_of_change(trace), 2.2, 1.5 * kPeriod);
  EXPECT_NEAR(trace.acceleration[100], 0.05 / 4.4, 1e-15);
  EXPECT_EQ(trace.acceleration.back(), 0.0);
}

TEST(Ramp, SpeedAndAccelerationStayContinuousWhenRetargeted) {
  const double peak = 0.05 / (4.4 * 0.7);
  for (const double at : {0.3, 1.0, 2.2, 3.2, 3.5}) {
    for (const double target : {0.05, 0.02, 0.0, -0.05}) {
      RampState state;
      follow(settings(), state, 0.04, at);
      const RampState before = state;
      const Trace trace = follow(settings(), state, target, 12.0);
      double last_speed = before.speed;
      double last_acceleration = before.acceleration;
      for (std::size_t i = 0; i < trace.speed.size(); ++i) {
        ASSERT_LE(std::abs(trace.speed[i] - last_speed), peak * kPeriod * (1.0 + 1e-9)) << at << ' ' << target << ' ' << i;
        // The steepest jerk is that of the first target: the peak within 30 % of 0.8 * 4.4 s. The new profile
        // begins within a period, so two of its steps may fall into one.
        ASSERT_LE(std::abs(trace.acceleration[i] - last_acceleration), 2.0 * peak * kPeriod / (0.3 * 0.8 * 4.4))
            << at << ' ' << target << ' ' << i;
        last_speed = trace.speed[i];
        last_acceleration = trace.acceleration[i];
      }
      EXPECT_EQ(trace.speed.back(), target);
      EXPECT_EQ(trace.acceleration.back(), 0.0);
    }
  }
}

// A target equal to the present speed while still accelerating: the acceleration cannot vanish at once, the
// speed swings past and comes back.
TEST(Ramp, RetargetToThePresentSpeedDoesNotJump) {
  RampState state;
  follow(settings(), state, 0.05, 2.2);
  const double speed = state.speed;
  const double acceleration = state.acceleration;
  ASSERT_GT(acceleration, 0.0);
  const Trace trace = follow(settings(), state, speed, 6.0);
  EXPECT_NEAR(trace.acceleration[1], acceleration, 0.01 * acceleration);
  EXPECT_GT(largest(trace.speed), speed);
  EXPECT_EQ(trace.speed.back(), speed);
}

TEST(Ramp, SpeedStaysWithinTopSpeedWhateverTheOperatorDoes) {
  std::mt19937_64 random(1);
  for (int run = 0; run < 50; ++run) {
    RampState state;
    for (int move = 0; move < 20; ++move) {
      const double target = 0.05 * std::uniform_real_distribution<double>(-1.0, 1.0)(random);
      const double held = std::uniform_real_distribution<double>(0.01, 3.0)(random);
      const Trace trace = follow(settings(), state, move % 4 == 0 ? std::copysign(0.05, target) : target, held);
      for (const double speed : trace.speed) ASSERT_LE(std::abs(speed), 0.05 * (1.0 + 1e-12));
    }
    follow(settings(), state, 0.0, 12.0);
    ASSERT_EQ(state.speed, 0.0);
  }
}

// A joystick is never still: the target moves a little in every cycle.
TEST(Ramp, ConvergesUnderATremblingTarget) {
  std::mt19937_64 random(2);
  RampState state;
  const double tremble = 0.05 * 0.002;
  for (int i = 0; i < 10000; ++i) {
    step_ramp(settings(), state, kPeriod, 0.03 + tremble * std::uniform_real_distribution<double>(-1.0, 1.0)(random));
    if (i > 8000) {
      ASSERT_NEAR(state.speed, 0.03, 2.0 * tremble);
    }
  }
}

TEST(Ramp, TargetIsClampedToTopSpeed) {
  RampState state;
  follow(settings(), state, 1.0, 6.0);
  EXPECT_EQ(state.speed, 0.05);
}

TEST(Ramp, EmergencyStopIsLinearFromAnySpeed) {
  for (const double share : {1.0, 0.5, -0.5}) {
    RampState state;
    follow(settings(), state, 0.05 * share, 6.0);
    const double start = state.speed;
    step_emergency_stop(settings(), state, kPeriod);
    for (int i = 1; i <= 1600; ++i) {
      step_emergency_stop(settings(), state, kPeriod);
      const double expected = std::max(0.0, std::abs(start) - 0.05 / 1.5 * i * kPeriod);
      ASSERT_NEAR(std::abs(state.speed), expected, 1e-14) << i;
    }
    EXPECT_EQ(state.speed, 0.0);
    EXPECT_EQ(state.acceleration, 0.0);
  }
}

TEST(Ramp, EmergencyStopCutsAnSCurveShort) {
  RampState state;
  follow(settings(), state, 0.05, 2.2);
  const double speed = state.speed;
  step_emergency_stop(settings(), state, kPeriod);
  const double at_press = state.speed;
  EXPECT_NEAR(at_press, speed, 0.02 * kPeriod);
  step_emergency_stop(settings(), state, kPeriod);
  EXPECT_NEAR(state.speed, at_press - 0.05 / 1.5 * kPeriod, 1e-15);
}

// The longer the period, the fewer samples of the same curve: the profile has a closed form.
TEST(Ramp, DoesNotDependOnThePeriod) {
  for (const double period : {1e-3, 2e-3, 5e-3, 10e-3, 20e-3}) {
    RampState state;
    step_ramp(settings(), state, period, 0.05);
    for (int i = 0; i < std::lround(1.1 / period); ++i) step_ramp(settings(), state, period, 0.05);
    const double peak = 0.05 / (4.4 * 0.7);
    EXPECT_NEAR(state.speed, 0.5 * peak * 1.1 * 1.1 / 1.32, 1e-12) << period;
  }
}

}  // namespace
}  // namespace slewlab::controller
