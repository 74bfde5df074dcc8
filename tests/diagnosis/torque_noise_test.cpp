#include "diagnosis/torque_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

namespace slewlab::diagnosis {
namespace {

constexpr std::size_t kCount = 4000;
constexpr double kCycle = 0.01;  // [s]
constexpr double kQuantum = 4e-4;  // [rad]

struct Messages {
  std::vector<msgs::Encoder> encoder;
  std::vector<msgs::Torque> torque;
};

// Two motors that swing at 0.5 and 5 Hz, and a speed controller that hears of their counted positions and noisy speeds through a filter of three cycles, holds each command for
// `hold` cycles, and follows a ramp with kinks.
Messages commanded(std::size_t hold = 1) {
  std::mt19937_64 engine(3);
  std::normal_distribution<double> normal(0.0, 0.02);  // [rad/s] of the speeds' noise
  Messages messages;
  for (std::size_t n = 0; n < kCount; ++n) {
    const double time = kCycle * static_cast<double>(n);
    msgs::Encoder encoder{};
    msgs::Torque torque{};
    encoder.simulated_time = torque.simulated_time = static_cast<std::int64_t>(n) * 10'000'000;
    encoder.group_count = torque.group_count = 2;
    encoder.shaft_position.resize(2);
    encoder.shaft_speed.resize(2);
    torque.motor_torque.resize(2);
    for (std::size_t g = 0; g < 2; ++g) {
      const double swing = std::sin(2.0 * std::numbers::pi * 0.5 * time) + 0.05 * std::sin(2.0 * std::numbers::pi * 5.0 * time + static_cast<double>(g));
      encoder.shaft_position[g] = kQuantum * std::round(10.0 * swing / kQuantum);
      encoder.shaft_speed[g] = 10.0 * std::cos(2.0 * std::numbers::pi * 0.5 * time) + normal(engine);
      const double ramp = std::fmod(time, 8.0) < 4.0 ? std::fmod(time, 8.0) : 8.0 - std::fmod(time, 8.0);
      torque.motor_torque[g] = 20.0 * ramp;
      for (std::size_t j = 0; j < 3; ++j) {
        const msgs::Encoder& heard = n >= j + 1 && j > 0 ? messages.encoder[n - j] : encoder;
        torque.motor_torque[g] -= (50.0 * heard.shaft_position[g] + 20.0 * heard.shaft_speed[g]) / 3.0;
      }
      if (n % hold != 0) torque.motor_torque[g] = messages.torque.back().motor_torque[g];
    }
    messages.encoder.push_back(encoder);
    messages.torque.push_back(torque);
  }
  return messages;
}

// Fast torques of 0.4 Nm that the readings' noise makes are commands like others.
TEST(TorqueNoise, IsNoneWhereACommandIsMadeOfTheReadings) {
  const Messages messages = commanded();
  EXPECT_LT(torque_noise(messages.encoder, messages.torque), 0.02 * 0.02);
}

// Of as many differences the deviation is known to some 2 %.
TEST(TorqueNoise, IsThatOfAMeasuredTorque) {
  Messages messages = commanded();
  std::mt19937_64 engine(4);
  std::normal_distribution<double> normal(0.0, 0.5);
  for (msgs::Torque& torque : messages.torque) torque.motor_torque[1] += normal(engine);
  EXPECT_NEAR(std::sqrt(torque_noise(messages.encoder, messages.torque)), 0.5, 0.04);
}

TEST(TorqueNoise, IsNoneWhereCommandsAreHeld) {
  const Messages messages = commanded(2);
  EXPECT_EQ(torque_noise(messages.encoder, messages.torque), 0.0);
}

TEST(TorqueNoise, IsNotToldFromAFewTorques) {
  Messages messages = commanded();
  messages.torque.resize(300);  // of 32 unknowns ten differences each
  EXPECT_EQ(torque_noise(messages.encoder, messages.torque), 0.0);
  EXPECT_EQ(torque_noise({}, {}), 0.0);
}

}  // namespace
}  // namespace slewlab::diagnosis
