// Expected: counts by hand, the tracking loop's theory (a loop of second order follows a ramp without lag), the
// noise's stated RMS and its spectrum's slope.
#include "diagnosis/evaluation/measure.h"

#include <gtest/gtest.h>

#include <cmath>

namespace slewlab::diagnosis::withheld {
namespace {

TEST(CountingEncoder, PositionsAreWholeCounts) {
  CountingEncoder encoder({.resolution = 0.01, .window = 0.0}, 0.3);
  encoder.update(0.0);
  EXPECT_EQ(encoder.position(), 0.0);
  encoder.update(0.0069);  // 0.3 + 0.69 counts: still on the first
  EXPECT_EQ(encoder.position(), 0.0);
  encoder.update(0.0071);
  EXPECT_DOUBLE_EQ(encoder.position(), 0.01);
  encoder.update(-0.0031);
  EXPECT_DOUBLE_EQ(encoder.position(), -0.01);
}

TEST(CountingEncoder, TrackingLoopFollowsASteadySpeedWithoutLag) {
  CountingEncoder encoder({.resolution = 0.0, .window = 0.0}, 0.0);
  constexpr double kSpeed = 137.0;  // [rad/s]
  for (int n = 0; n <= 200; ++n) encoder.update(kSpeed * n * kBaseStep);
  EXPECT_NEAR(encoder.speed(), kSpeed, 1e-9);
}

TEST(CountingEncoder, WindowGivesTheMeanSpeed) {
  CountingEncoder encoder({.resolution = 0.0, .window = 0.005}, 0.0);
  for (int n = 0; n <= 20; ++n) encoder.update(2.0 * n * kBaseStep);
  EXPECT_NEAR(encoder.speed(), 2.0, 1e-12);
}

TEST(ColouredNoise, HasTheStatedSizeAndMorePowerBelow) {
  ColouredNoise noise({.accelerometer = 0.005, .flicker_share = 0.5, .slew_resolution = 0.0}, Random(1, "test"));
  constexpr int kBlocks = 4000, kLength = 100;
  double square = 0.0, block_square = 0.0;
  for (int b = 0; b < kBlocks; ++b) {
    double sum = 0.0;
    for (int n = 0; n < kLength; ++n) {
      const double value = noise.next();
      square += value * value;
      sum += value;
    }
    block_square += sum * sum / (kLength * kLength);
  }
  const double rms = std::sqrt(square / (kBlocks * kLength));
  EXPECT_NEAR(rms, 0.005, 0.0005);
  // White noise of this size would leave rms / 10 in means of 100.
  EXPECT_GT(std::sqrt(block_square / kBlocks), 3.0 * rms / 10.0);
}

}  // namespace
}  // namespace slewlab::diagnosis::withheld
