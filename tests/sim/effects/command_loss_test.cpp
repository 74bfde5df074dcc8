#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "sim/effects/random_number.h"
#include "sim/integrate/machine.h"
#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

constexpr std::uint64_t kSeed = 11;

// Which of `count` messages, sequences from 1 on, are lost.
std::vector<bool> lost_messages(double probability, double burst, int count) {
  const Machine machine = make_machine({.crane = fixed_house(), .effects = {}});
  const std::vector<double> values{probability, burst};
  const auto effect = started("command_loss", values, machine.model, kSeed);
  std::vector<bool> lost;
  for (int sequence = 1; sequence <= count; ++sequence) {
    DriveCommand command;
    command.sequence = sequence;
    effect->message(0.01 * sequence, command);
    lost.push_back(command.sequence != sequence);
  }
  return lost;
}

TEST(CommandLoss, HoldsTheLastThatArrived) {
  const auto samples = run(fixed_house(), "command_loss", {0.3, 1.0}, 30.0, [](double time) {
    DriveCommand command;
    command.sequence = std::lround(std::floor(time / 0.010 + 1e-6)) + 1;
    command.motor_torque = {static_cast<double>(command.sequence), 0.0};
    return command;
  });
  int lost = 0, count = 0;
  for (std::size_t k = 9; k < samples.size(); k += 10) {
    const std::size_t message = k / 10 + 1;
    const auto sent = static_cast<double>(message);
    const double held = samples[k].applied_torque[0];
    ++count;
    if (held == sent) continue;
    ++lost;
    const double before = k >= 10 ? samples[k - 10].applied_torque[0] : 0.0;
    EXPECT_EQ(held, before) << k;
  }
  // 3000 messages: one standard deviation of the share is 0.008.
  EXPECT_NEAR(static_cast<double>(lost) / count, 0.3, 0.03);
}

// Independent loss: each message on its own, by the number drawn for its sequence.
TEST(CommandLoss, BurstOfOneIsIndependentLoss) {
  for (const double probability : {0.03, 0.3, 0.7}) {
    const std::vector<bool> lost = lost_messages(probability, 1.0, 5000);
    for (std::size_t k = 0; k < lost.size(); ++k) {
      EXPECT_EQ(lost[k], uniform_number(kSeed, k + 1) < probability) << probability << " " << k;
    }
  }
}

// Renewals, with D = burst (1 - p) + p: the share of n messages has the mean p and the variance p (1 - p) D / n (a burst's
// wait is geometric with q = p / D). A stretch is a geometric number of whole bursts: mean D / (1 - p), variance
// burst^2 q / (1 - q)^2.
TEST(CommandLoss, BurstsKeepTheShareAndHaveTheirLength) {
  constexpr int kCount = 200000;
  for (const double probability : {0.05, 0.3, 0.8}) {
    for (const int burst : {1, 5, 20}) {
      const std::vector<bool> lost = lost_messages(probability, burst, kCount);
      const double d = burst * (1.0 - probability) + probability, q = probability / d;
      int sum = 0, length = 0, stretches = 0;
      long in_stretches = 0;
      for (const bool now : lost) {
        if (now) {
          ++sum;
          ++length;
        } else if (length > 0) {
          EXPECT_EQ(length % burst, 0) << probability << " " << burst;
          ++stretches;
          in_stretches += length;
          length = 0;
        }
      }
      EXPECT_NEAR(static_cast<double>(sum) / kCount, probability,
                  4.0 * std::sqrt(probability * (1.0 - probability) * d / kCount))
          << burst;
      ASSERT_GT(stretches, 300);
      EXPECT_NEAR(static_cast<double>(in_stretches) / stretches, d / (1.0 - probability),
                  4.0 * burst * std::sqrt(q / stretches) / (1.0 - q))
          << probability << " " << burst;
    }
  }
}

}  // namespace
}  // namespace slewlab::sim
