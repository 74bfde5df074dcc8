#include "diagnosis/sensor_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace slewlab::diagnosis {
namespace {

constexpr std::size_t kCount = 20000;
constexpr double kStep = 1e-3;  // [s]

std::vector<double> white(double deviation) {
  std::mt19937_64 engine(11);
  std::normal_distribution<double> normal(0.0, deviation);
  std::vector<double> values;
  for (std::size_t n = 0; n < kCount; ++n) values.push_back(normal(engine));
  return values;
}

// A swing of a hundred times the noise at the highest bending mode of the thesis's crane that matters.
double motion(std::size_t n) { return std::sin(2.0 * std::numbers::pi * 38.0 * kStep * static_cast<double>(n)); }

Record standing() {
  Record record;
  record.step = record.encoder_period = record.sensor_period = kStep;
  record.group_count = 1;
  record.motor_torque[0].assign(kCount, 0.0);
  record.shaft_position[0].assign(kCount, 0.0);
  return record;
}

TEST(SensorNoise, IsToldFromBesideAMotion) {
  Record record = standing();
  record.acceleration[kTip] = white(0.01);
  record.shaft_position[0] = white(1e-4);
  for (std::size_t n = 0; n < kCount; ++n) {
    record.acceleration[kTip][n] += motion(n);
    record.shaft_position[0][n] += 5.0 * kStep * static_cast<double>(n) + 0.01 * motion(n);
  }
  const SensorNoise noise = sensor_noise(record);
  EXPECT_NEAR(std::sqrt(noise.accelerometer[kTip]), 0.01, 0.001);
  EXPECT_NEAR(std::sqrt(noise.encoder[0]), 1e-4, 1e-5);
  EXPECT_EQ(noise.accelerometer[0], 0.0);  // not measured
}

// One position in four is a reading, the others lie between.
TEST(SensorNoise, OfAnEncoderIsThatOfItsReadings) {
  Record record = standing();
  record.encoder_period = 4.0 * kStep;
  const std::vector<double> readings = white(1e-4);
  for (std::size_t n = 0; n < kCount; ++n) record.shaft_position[0][n] = readings[n / 4];
  EXPECT_NEAR(std::sqrt(sensor_noise(record).encoder[0]), 1e-4, 1e-5);
}

TEST(SensorNoise, OfAnEncoderIsAtLeastThatOfItsCounts) {
  Record record = standing();
  record.encoder_quantum = 1e-3;  // [rad]
  EXPECT_DOUBLE_EQ(sensor_noise(record).encoder[0], 1e-6 / 12.0);
}

TEST(SensorNoise, OfATorqueIsThatOfItsSteps) {
  Record record = standing();
  EXPECT_EQ(sensor_noise(record).torque, 0.0);
  record.torque_noise = 0.04;  // [Nm^2] per command
  EXPECT_DOUBLE_EQ(sensor_noise(record).torque, 0.04);
  record.encoder_period = 5.0 * kStep;  // for which a command holds: one error in five times the power of five
  EXPECT_DOUBLE_EQ(sensor_noise(record).torque, 0.2);
}

// Sampled every third step: the same noise in pieces three times as long has three times the power of what is white on the grid.
TEST(SensorNoise, OfASlowSensorIsLongerOnTheGrid) {
  Record record = standing();
  record.sensor_period = 3.0 * kStep;
  record.sampled_acceleration[kTip] = white(0.01);
  for (std::size_t n = 0; n < kCount; ++n) record.sampled_at.push_back(static_cast<std::int64_t>(n) * 3'000'000);
  record.acceleration[kTip].assign(kCount, 0.0);
  EXPECT_NEAR(sensor_noise(record).accelerometer[kTip], 3e-4, 3e-5);
}

}  // namespace
}  // namespace slewlab::diagnosis
