#include "controller/process/computed_answer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "controller/controller_file.h"

namespace slewlab::controller {
namespace {

constexpr std::int64_t kPeriod = 10'000'000;  // [ns]

// The thesis's controller, asked by shafts that stand still.
class ComputedAnswer : public testing::Test {
 protected:
  static ControllerSettings settings() {
    ControllerSettings settings = load_controller_file(SLEWLAB_SOURCE_DIR "/config/controllers/thesis.yaml").settings;
    settings.period = 1e-9 * kPeriod;
    return settings;
  }

  msgs::Encoder encoder() const {
    msgs::Encoder message{};
    message.sequence = cycle_;
    message.simulated_time = cycle_ * kPeriod;
    message.group_count = 2;
    message.shaft_speed = message.shaft_position = {0.0, 0.0};
    return message;
  }
  void ask(const msgs::Encoder& message) {
    ++cycle_;
    compute(message, operator_move, torque, state);
  }

  bool all_finite() const {
    for (const auto* list : {&torque.motor_torque, &state.proportional_torque, &state.integral_torque}) {
      for (const double value : *list) {
        if (!std::isfinite(value)) return false;
      }
    }
    return std::isfinite(state.average_torque) && std::isfinite(state.offset_torque);
  }

  Compute compute = computed_answer(settings());
  msgs::Operator operator_move{};
  msgs::Torque torque{};
  msgs::ControllerState state{};

 private:
  std::int64_t cycle_ = 0;
};

double with_bit_turned(double value, int bit) {
  std::uint64_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  bits ^= std::uint64_t{1} << bit;
  std::memcpy(&value, &bits, sizeof bits);
  return value;
}

// Whatever bit of a speed is turned over on its way: the answer is finite and the drives stay on; where the shaft cannot
// have that speed, the answer is the one to the reading before.
TEST_F(ComputedAnswer, OneTurnedBitDoesNoHarm) {
  for (int i = 0; i < 100; ++i) ask(encoder());
  const Compute before = compute;
  ask(encoder());
  const double undisturbed = torque.motor_torque[0];
  const PlausibilitySettings& limits = settings().plausibility;
  const double possible = limits.acceleration_limit * settings().period + limits.tolerance;
  int refused = 0;
  for (const double speed : {0.0, 0.75, -1.5, 6.0}) {
    for (int bit = 0; bit < 64; ++bit) {
      const double turned = with_bit_turned(speed, bit);
      if (!std::isfinite(turned)) continue;  // no signal: the drives are let go
      compute = before;
      msgs::Encoder message = encoder();
      message.sequence = 100;
      message.simulated_time = 100 * kPeriod;
      message.shaft_speed[0] = turned;
      ask(message);
      EXPECT_TRUE(all_finite()) << speed << ", bit " << bit;
      EXPECT_TRUE(torque.enable) << speed << ", bit " << bit;
      if (std::fabs(turned) <= possible) continue;
      ++refused;
      EXPECT_EQ(torque.motor_torque[0], undisturbed) << speed << ", bit " << bit;
    }
  }
  EXPECT_GT(refused, 4) << "the upper bits of the exponent";
}

TEST_F(ComputedAnswer, ASpeedThatNoMotorHasLetsTheDriveGo) {
  for (int i = 0; i < 10; ++i) ask(encoder());
  for (int i = 0; i < 5; ++i) {  // 50 ms, the time-out of config/controllers/thesis.yaml
    msgs::Encoder message = encoder();
    message.shaft_speed = {1e308, 1e308};
    ask(message);
    EXPECT_TRUE(torque.enable) << i;
    EXPECT_TRUE(all_finite()) << i;
  }
  msgs::Encoder message = encoder();
  message.shaft_speed = {1e308, 1e308};
  ask(message);
  EXPECT_FALSE(torque.enable);
  EXPECT_TRUE(torque.brake);
  EXPECT_EQ(torque.motor_torque[0], 0.0);
  EXPECT_EQ(state.mode, static_cast<std::int8_t>(Mode::waiting_for_acknowledgement));
}

// The drive would be enabled again under a speed controller that has wound up against the brakes.
TEST_F(ComputedAnswer, AcknowledgesATripWithTheLeverAtZeroAlone) {
  operator_move.acknowledge = true;
  operator_move.speed_request = 0.4;
  ask(encoder());
  EXPECT_FALSE(torque.acknowledge);
  operator_move.speed_request = 0.0;
  ask(encoder());
  EXPECT_TRUE(torque.acknowledge);
  operator_move.acknowledge = false;
  ask(encoder());
  EXPECT_FALSE(torque.acknowledge);
  // Also where there is nothing to control by: drive and controller are acknowledged at once.
  operator_move.acknowledge = true;
  msgs::Encoder message = encoder();
  message.shaft_speed = {std::nan(""), std::nan("")};
  ask(message);
  EXPECT_FALSE(torque.enable);
  EXPECT_TRUE(torque.acknowledge);
}

// Thesis Table 3.4: at rest and without torque the groups stand at 10 and -10 % of T100 with the compensation, at 0 without.
TEST_F(ComputedAnswer, SwitchesThePlayCompensationFromTheTimeThatIsSaid) {
  std::vector<PlaySwitch> switched;
  compute = computed_answer(settings(), &switched);
  for (int i = 0; i < 100; ++i) ask(encoder());
  const double held = 0.1 * settings().rated_torque;
  EXPECT_NEAR(torque.motor_torque[0], held, 1e-9);
  EXPECT_NEAR(torque.motor_torque[1], -held, 1e-9);
  switched.push_back({.time = 102 * kPeriod, .enabled = false});
  for (int i = 100; i < 102; ++i) {
    ask(encoder());
    EXPECT_NEAR(torque.motor_torque[0], held, 1e-9) << i;
  }
  ask(encoder());
  EXPECT_EQ(state.offset_torque, 0.0);
  for (int i = 0; i < 100; ++i) ask(encoder());
  EXPECT_NEAR(torque.motor_torque[0], 0.0, 1e-9);
  EXPECT_NEAR(torque.motor_torque[1], 0.0, 1e-9);
}

}  // namespace
}  // namespace slewlab::controller
