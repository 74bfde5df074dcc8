// The answer to noise on made-up runs whose controller is a known sum over the readings.
#include "tools/acceptance/dead_time.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace slewlab::tools {
namespace {

constexpr double kNoise = 0.2;  // [rad/s]
constexpr double kGain = 40.0;  // [N m s/rad]

// `torque(k, speed)` of the answer to reading k.
msgs::RunLog log_of(const std::function<double(int, const std::vector<double>&)>& torque, double noise = kNoise) {
  msgs::RunLog log;
  std::mt19937_64 draw(1);
  std::normal_distribution<double> normal;
  std::vector<double> speed;
  for (int k = 0; k < 2000; ++k) {
    msgs::Encoder encoder{};
    encoder.sequence = 7 + k;
    encoder.simulated_time = 10'000'000LL * k;
    speed.push_back(100.0 * std::sin(1e-2 * k) + noise * normal(draw));
    encoder.shaft_speed = {speed.back() - 1.0, speed.back() + 1.0};
    log.encoder.push_back(encoder);
    msgs::Torque answer{};
    answer.answered_sequence = encoder.sequence;
    answer.enable = 1;
    const double each = torque(k, speed);
    answer.motor_torque = {each + 25.0, each - 25.0};
    log.torque.push_back(answer);
  }
  return log;
}

// Proportional control d readings back is found at d; what a ramp adds is not seen.
TEST(DeadTime, IsTheFirstReadingThatMovesTheTorque) {
  for (int lag = 0; lag < 4; ++lag) {
    const AnswerToNoise found = answer_to_noise(log_of([lag](int k, const std::vector<double>& speed) {
      return 0.5 * k - kGain * speed[static_cast<std::size_t>(std::max(0, k - lag))];
    }), 0.0, 20.0);
    EXPECT_EQ(found.lag, lag);
    EXPECT_NEAR(found.answer[static_cast<std::size_t>(lag)], -kGain, 0.01);
  }
}

// A filter answers at once, with the first of its weights 1 - exp(-period / time).
TEST(DeadTime, AFilterIsNone) {
  double filtered = 0.0;
  const double weight = 1.0 - std::exp(-0.01 / 0.05);
  const AnswerToNoise found = answer_to_noise(log_of([&](int, const std::vector<double>& speed) {
    filtered += weight * (speed.back() - filtered);
    return -kGain * filtered;
  }), 0.0, 20.0);
  EXPECT_EQ(found.lag, 0);
  EXPECT_NEAR(found.answer[0] / (-kGain * weight), 1.0, 0.05);
}

// Without noise, with a torque that does not answer it, outside the time, or with nobody at the controls nothing is said.
TEST(DeadTime, IsNotSaidWithoutNoise) {
  const auto proportional = [](int, const std::vector<double>& speed) { return -kGain * speed.back(); };
  std::mt19937_64 draw(2);
  std::normal_distribution<double> normal;
  EXPECT_EQ(answer_to_noise(log_of([&](int, const std::vector<double>&) { return kGain * kNoise * normal(draw); }), 0.0, 20.0).lag, -1);
  EXPECT_EQ(answer_to_noise(log_of([](int, const std::vector<double>&) { return 3.0; }), 0.0, 20.0).lag, -1);
  EXPECT_EQ(answer_to_noise(log_of(proportional), 30.0, 40.0).lag, -1);
  EXPECT_EQ(answer_to_noise({}, 0.0, 20.0).lag, -1);
  msgs::RunLog released = log_of(proportional);
  for (msgs::Torque& torque : released.torque) torque.enable = 0;
  EXPECT_EQ(answer_to_noise(released, 0.0, 20.0).lag, -1);
  EXPECT_EQ(answer_to_noise(log_of(proportional), 0.0, 20.0).lag, 0);
}

}  // namespace
}  // namespace slewlab::tools
