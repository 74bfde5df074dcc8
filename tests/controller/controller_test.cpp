#include "controller/controller.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "controller/controller_file.h"
#include "tests/common/allocation_guard.h"

namespace slewlab::controller {
namespace {

constexpr double kFreeInertia = 100.0;  // [kg m^2] per motor on the fast axis

// A controller with a bare inertia behind each group.
class Loop {
 public:
  explicit Loop(const ControllerSettings& settings) : settings_(settings) {
    input.group_count = settings.group_count;
  }

  void run(double duration) {
    const int steps = static_cast<int>(std::lround(duration / settings_.period));
    for (int i = 0; i < steps; ++i) cycle();
  }
  void cycle() {
    step(settings_, state, input, output);
    for (int g = 0; g < settings_.group_count; ++g) {
      input.shaft_speed[g] += settings_.period * output.motor_torque[g] / kFreeInertia;
    }
    input.simulated_time += static_cast<std::int64_t>(std::lround(settings_.period * 1e9));
  }

  ControllerState state;
  ControllerInput input;
  ControllerOutput output;

 private:
  ControllerSettings settings_;
};

ControllerSettings thesis(double period = 0.01) {
  ControllerSettings settings =
      load_controller_file(SLEWLAB_SOURCE_DIR "/config/controllers/thesis.yaml").settings;
  settings.period = period;
  return settings;
}

ControllerSettings without_play_compensation(double period = 0.01) {
  ControllerSettings settings = thesis(period);
  settings.play_compensation.enabled = false;
  return settings;
}

TEST(Controller, BringsTheShaftsToTheRequestedSpeedForEveryPeriod) {
  for (const double period : {1e-3, 2e-3, 5e-3, 10e-3, 20e-3}) {
    Loop loop(without_play_compensation(period));
    loop.input.speed_request = 0.5;
    loop.run(100.0);
    for (int g = 0; g < 2; ++g) {
      EXPECT_NEAR(loop.input.shaft_speed[g], 0.5 * 0.05 * 215.4 * 12.7, 1e-3) << period;
    }
    EXPECT_EQ(loop.output.mode, Mode::running);
    EXPECT_DOUBLE_EQ(loop.output.ramped_speed, 0.025);
  }
}

TEST(Controller, StandsStillUntilAsked) {
  Loop loop(without_play_compensation());
  loop.run(1.0);
  EXPECT_EQ(loop.output.mode, Mode::stopped);
  EXPECT_EQ(loop.output.motor_torque[0], 0.0);
  EXPECT_TRUE(loop.output.enable);
}

// Thesis Table 3.4 at 3.0 s: at standstill the groups pull against each other with 10 % of T100.
TEST(Controller, PlayCompensationTensionsTheGearsAtStandstill) {
  const ControllerSettings settings = thesis();
  ControllerState state;
  ControllerInput input;
  input.group_count = 2;
  ControllerOutput output;
  for (int i = 0; i < 100; ++i) step(settings, state, input, output);
  EXPECT_NEAR(output.motor_torque[0], 0.1 * settings.rated_torque, 1e-9);
  EXPECT_NEAR(output.motor_torque[1], -0.1 * settings.rated_torque, 1e-9);
  EXPECT_NEAR(output.offset_torque, 0.1 * settings.rated_torque, 1e-9);
  EXPECT_EQ(output.average_torque, 0.0);
}

// Table 3.4 through the whole controller: the groups' speeds are set so that the PI asks for the average.
TEST(Controller, PlayCompensationMapsTheAverageOfTheGroups) {
  ControllerSettings settings = thesis();
  settings.limits.rate = std::numeric_limits<double>::infinity();
  for (const double average : {0.0, 18.0, 48.0, 57.0, -18.0}) {
    ControllerState state;
    ControllerInput input;
    input.group_count = 2;
    const double torque = average / 100.0 * settings.rated_torque;
    for (int g = 0; g < 2; ++g) state.speed_control[g].integral_torque = torque;
    ControllerOutput output;
    step(settings, state, input, output);
    const HalfTorques expected = evaluate_play_map(settings.play_compensation, average / 100.0);
    EXPECT_NEAR(output.average_torque, torque, 1e-9);
    EXPECT_NEAR(output.motor_torque[0], expected.half_1 * settings.rated_torque, 1e-9) << average;
    EXPECT_NEAR(output.motor_torque[1], expected.half_2 * settings.rated_torque, 1e-9) << average;
  }
}

// The offset moves the groups apart by their play: one shaft a little forward, one back, then both at rest. The
// torques must stay on the map, not drift back as two integrals of their own would let them.
TEST(Controller, OffsetStaysWhenTheGroupsHaveMovedApart) {
  const ControllerSettings settings = thesis();
  ControllerState state;
  ControllerInput input;
  input.group_count = 2;
  ControllerOutput output;
  for (int i = 0; i < 400; ++i) {
    const bool moving = i >= 100 && i < 200;
    input.shaft_speed[0] = moving ? 0.7 : 0.0;  // [rad/s]
    input.shaft_speed[1] = -input.shaft_speed[0];
    step(settings, state, input, output);
  }
  EXPECT_NEAR(output.motor_torque[0], 0.1 * settings.rated_torque, 1e-9);
  EXPECT_NEAR(output.motor_torque[1], -0.1 * settings.rated_torque, 1e-9);
}

// Each group's own proportional part remains: it damps the motion of the groups against each other.
TEST(Controller, GroupsAreDampedAgainstEachOther) {
  const ControllerSettings settings = thesis();
  ControllerState state;
  ControllerInput input;
  input.group_count = 2;
  ControllerOutput output;
  for (int i = 0; i < 100; ++i) step(settings, state, input, output);
  input.shaft_speed[0] = 0.01;
  input.shaft_speed[1] = -0.01;
  step(settings, state, input, output);
  const double damping = settings.speed_control.proportional_gain * 0.01;
  EXPECT_NEAR(output.motor_torque[0], 0.1 * settings.rated_torque - damping, 0.01 * damping);
  EXPECT_NEAR(output.motor_torque[1], -0.1 * settings.rated_torque + damping, 0.01 * damping);
}

TEST(Controller, OneGroupGetsNoPlayCompensation) {
  ControllerSettings settings = thesis();
  settings.group_count = 1;
  Loop loop(settings);
  loop.run(0.5);
  EXPECT_EQ(loop.output.motor_torque[0], 0.0);
  EXPECT_EQ(loop.output.offset_torque, 0.0);
}

TEST(Controller, TorqueStaysWithinItsLimits) {
  const ControllerSettings settings = thesis();
  ControllerState state;
  ControllerInput input;
  input.group_count = 2;
  ControllerOutput output;
  PerGroup last{};
  for (int i = 0; i < 2000; ++i) {
    input.shaft_speed[0] = 300.0 * std::sin(0.05 * i);
    input.shaft_speed[1] = -200.0 * std::sin(0.11 * i);
    input.speed_request = std::sin(0.003 * i);
    step(settings, state, input, output);
    for (int g = 0; g < 2; ++g) {
      ASSERT_LE(std::abs(output.motor_torque[g]), settings.limits.torque);
      ASSERT_LE(std::abs(output.motor_torque[g] - last[g]), settings.limits.rate * settings.period * (1 + 1e-12));
    }
    last = output.motor_torque;
  }
}

// A shaft that is held: the PI must wind up to what the motors may give, not to their rated torque, be that less or more.
TEST(Controller, WindsUpToTheTorqueLimit) {
  for (const bool compensated : {false, true}) {
    for (const double share : {0.6, 1.0, 1.5}) {
      ControllerSettings settings = thesis();
      settings.play_compensation.enabled = compensated;
      settings.limits.torque = share * settings.rated_torque;
      ControllerState state;
      ControllerInput input;
      input.group_count = 2;
      input.speed_request = 1.0;
      ControllerOutput output;
      for (int i = 0; i < 2000; ++i) step(settings, state, input, output);
      EXPECT_EQ(output.average_torque, settings.limits.torque);
      for (int g = 0; g < 2; ++g) {
        EXPECT_LE(output.integral_torque[g], settings.limits.torque) << "share " << share;
        if (share >= 1.0) {
          EXPECT_DOUBLE_EQ(output.motor_torque[g], settings.limits.torque) << "share " << share << ", " << compensated;
        }
      }
    }
  }
}

TEST(Controller, EmergencyStopIsALinearRampAndLatches) {
  Loop loop(without_play_compensation());
  loop.input.speed_request = 1.0;
  loop.run(10.0);
  ASSERT_DOUBLE_EQ(loop.output.ramped_speed, 0.05);
  loop.input.emergency_stop = true;
  loop.cycle();
  EXPECT_EQ(loop.output.mode, Mode::emergency_stop);
  loop.input.emergency_stop = false;
  loop.run(0.75);
  EXPECT_EQ(loop.output.mode, Mode::emergency_stop);
  EXPECT_NEAR(loop.output.ramped_speed, 0.05 * (1.0 - 0.75 / 1.5), 1e-12);
  loop.run(1.0);
  EXPECT_EQ(loop.output.mode, Mode::waiting_for_acknowledgement);
  EXPECT_EQ(loop.output.ramped_speed, 0.0);
  // The request still stands: nothing moves, also after an acknowledgement.
  loop.input.acknowledge = true;
  loop.run(1.0);
  EXPECT_EQ(loop.output.mode, Mode::waiting_for_acknowledgement);
  EXPECT_EQ(loop.output.ramped_speed, 0.0);
  loop.input.speed_request = 0.0;
  loop.cycle();
  EXPECT_EQ(loop.output.mode, Mode::stopped);
  loop.input.acknowledge = false;
  loop.input.speed_request = 1.0;
  loop.run(1.0);
  EXPECT_EQ(loop.output.mode, Mode::running);
  EXPECT_GT(loop.output.ramped_speed, 0.0);
}

TEST(Controller, HeldButtonKeepsTheStop) {
  Loop loop(without_play_compensation());
  loop.input.speed_request = 1.0;
  loop.run(10.0);
  loop.input.emergency_stop = true;
  loop.input.speed_request = 0.0;
  loop.input.acknowledge = true;
  loop.run(5.0);
  EXPECT_EQ(loop.output.mode, Mode::emergency_stop);
}

TEST(Controller, UnusableMeasurementTakesTheTorqueAway) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Loop loop(without_play_compensation());
    loop.input.speed_request = 1.0;
    loop.run(5.0);
    const double good = loop.input.shaft_speed[1];
    loop.input.shaft_speed[1] = bad;
    loop.cycle();
    EXPECT_EQ(loop.output.mode, Mode::waiting_for_acknowledgement);
    EXPECT_FALSE(loop.output.enable);
    EXPECT_TRUE(loop.output.brake);
    EXPECT_EQ(loop.output.motor_torque[0], 0.0);
    EXPECT_EQ(loop.output.motor_torque[1], 0.0);
    loop.input.shaft_speed[1] = good;
    loop.cycle();
    EXPECT_FALSE(loop.output.enable) << "stays off until acknowledged";
    loop.input.speed_request = 0.0;
    loop.input.acknowledge = true;
    loop.cycle();
    EXPECT_TRUE(loop.output.enable);
    EXPECT_EQ(loop.output.mode, Mode::stopped);
    EXPECT_TRUE(std::isfinite(loop.output.motor_torque[1]));
  }
}

TEST(Controller, WrongGroupCountTakesTheTorqueAway) {
  Loop loop(thesis());
  loop.input.group_count = 3;
  loop.cycle();
  EXPECT_FALSE(loop.output.enable);
  EXPECT_EQ(loop.output.motor_torque[0], 0.0);
}

TEST(Controller, RequestThatIsNoNumberMeansZero) {
  Loop loop(without_play_compensation());
  loop.input.speed_request = std::numeric_limits<double>::quiet_NaN();
  loop.run(1.0);
  EXPECT_EQ(loop.output.mode, Mode::stopped);
  EXPECT_EQ(loop.output.motor_torque[0], 0.0);
}

TEST(Controller, SameInputsGiveTheSameBits) {
  Loop a(thesis());
  Loop b(thesis());
  for (Loop* loop : {&a, &b}) {
    loop->input.speed_request = 0.7;
    loop->run(8.0);
    loop->input.emergency_stop = true;
    loop->run(3.0);
  }
  EXPECT_EQ(a.output.motor_torque, b.output.motor_torque);
  EXPECT_EQ(a.input.shaft_speed, b.input.shaft_speed);
}

TEST(Controller, StepAllocatesNothing) {
  Loop loop(thesis());
  const tests::AllocationGuard guard;
  loop.input.speed_request = 1.0;
  loop.run(10.0);
  loop.input.emergency_stop = true;
  loop.run(3.0);
  loop.input.shaft_speed[0] = std::numeric_limits<double>::quiet_NaN();
  loop.run(0.1);
  EXPECT_EQ(guard.count(), 0);
}

}  // namespace
}  // namespace slewlab::controller
