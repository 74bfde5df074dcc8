#include "diagnosis/whitening.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace slewlab::diagnosis {
namespace {

constexpr std::size_t kCount = 30000;  // 30 s at 1 kHz

// Of noise that is white: no corner.
const WhiteningSettings kSettings{.highest_frequency = 40.0, .lowest_frequency = 0.02, .noise_corner = 0.0, .encoder_noise_from = 20.0, .soft_edge = 0.4,
                                  .least_torque = 1e-6, .least_acceleration = 1e-6};

std::vector<double> white(double deviation, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal(0.0, deviation);
  std::vector<double> values(kCount);
  for (double& value : values) value = normal(generator);
  return values;
}

// One group whose encoder stands, one accelerometer with noise of 0.01 m/s^2 alone.
Record noisy_record() {
  Record record;
  record.step = record.encoder_period = 1e-3;
  record.group_count = 1;
  record.motor_torque[0].assign(kCount, 0.0);
  record.shaft_speed[0].assign(kCount, 0.0);
  record.position_rate[0].assign(kCount, 0.0);
  record.shaft_position[0].assign(kCount, 0.0);
  record.acceleration[kTip] = white(0.01, 1);
  return record;
}

Shadow shadow_of(std::vector<double> tip_difference) {
  Shadow shadow;
  shadow.missing_torque[0].assign(kCount, 0.0);
  shadow.acceleration_difference[kTip] = std::move(tip_difference);
  shadow.contact_lost.assign(kCount, false);
  return shadow;
}

// Of an observer that neither the encoder nor the tip leads: what they read off is what it differs by.
NoiseResponse as_read() {
  const std::vector<double> one(transform_length(kCount) / 2 + 1, 1.0), none(one.size(), 0.0);
  NoiseResponse response;
  response.encoder[0].torque[0] = response.tip.acceleration[kTip] = one;
  response.encoder[0].acceleration[kTip] = response.tip.torque[0] = none;
  return response;
}

double mean_square(const Whitening& whitening, const Shadow& shadow, std::size_t channel) {
  const Eigen::VectorXd all = whiten(whitening, shadow);
  const auto rows = static_cast<Eigen::Index>(2 * whitening.bin_count);
  return all.segment(static_cast<Eigen::Index>(channel) * rows, rows).squaredNorm() / static_cast<double>(rows);
}

// The definition of the weights: noise alone leaves numbers of variance 1. About 2400 of them, so within 5 sigma of it.
TEST(Whitening, NoiseAloneHasVarianceOne) {
  const Record record = noisy_record();
  const WhiteningSettings settings = kSettings;
  const Whitening whitening =
      make_whitening(record, std::vector<bool>(kCount, true), as_read(), shadow_of(record.acceleration[kTip]), settings);
  ASSERT_EQ(whitening.channels.size(), 2U);
  EXPECT_NEAR(mean_square(whitening, shadow_of(white(0.01, 2)), 1), 1.0, 0.15);
  EXPECT_NEAR(mean_square(whitening, shadow_of(white(0.02, 3)), 1), 4.0, 0.6);
}

// What lies where the record is not trusted changes nothing.
TEST(Whitening, ForgetsWhatIsNotTrusted) {
  const Record record = noisy_record();
  std::vector<bool> trusted(kCount, true);
  std::fill(trusted.begin() + 10000, trusted.begin() + 15000, false);
  const Whitening whitening =
      make_whitening(record, trusted, as_read(), shadow_of(record.acceleration[kTip]), kSettings);
  std::vector<double> difference = white(0.01, 4);
  const Eigen::VectorXd before = whiten(whitening, shadow_of(difference));
  std::fill(difference.begin() + 10000, difference.begin() + 15000, 100.0);
  EXPECT_EQ((whiten(whitening, shadow_of(difference)) - before).norm(), 0.0);
}

}  // namespace
}  // namespace slewlab::diagnosis
