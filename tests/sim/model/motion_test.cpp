#include "sim/model/motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace slewlab::sim {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;  // [ns]

// A ramp of 1.5 v / a to full speed, and one back: the way is the speed times the time between the ramps' middles.
TEST(Motion, RampsKeepWithinTheAcceleration) {
  const MotionProfile profile({.top_speed = 0.5, .acceleration = 0.25}, {{2 * kSecond, 1.0}, {12 * kSecond, 0.0}});
  EXPECT_EQ(profile.at(1.9).way, 0.0);
  EXPECT_NEAR(profile.at(5.0).speed, 0.5, 1e-15);
  EXPECT_NEAR(profile.at(3.5).acceleration, 0.25, 1e-15);  // the ramp's middle
  EXPECT_NEAR(profile.at(20.0).way, 0.5 * 10.0, 1e-12);
  EXPECT_EQ(profile.at(20.0).acceleration, 0.0);
  EXPECT_NEAR(profile.at(20.0).speed, 0.0, 1e-15);
  EXPECT_FALSE(profile.moves_within(16.0, 17.0));
  EXPECT_TRUE(profile.moves_within(14.0, 17.0));
  EXPECT_FALSE(profile.moves_within(0.0, 2.0));
}

// Requests that come in the middle of ramps, either way: way, speed and acceleration have no jump, speed and acceleration are the way's
// derivatives, and the acceleration keeps to its limit.
TEST(Motion, ARequestWithinARampGoesOnFromIt) {
  const MotionRates rates{.top_speed = 0.5, .acceleration = 0.25};
  const MotionProfile profile(rates, {{0, 1.0}, {kSecond, -1.0}, {2 * kSecond, 0.3}, {2'500'000'000, 0.3}, {3 * kSecond, 0.0}, {20 * kSecond, 1.0}});
  constexpr double kStep = 1e-4;  // [s]
  for (int n = 0; n < 7884; ++n) {  // to 25 s
    const double t = 0.01 + 0.00317 * n;
    const MotionState before = profile.at(t - kStep), now = profile.at(t), after = profile.at(t + kStep);
    EXPECT_NEAR((after.way - before.way) / (2.0 * kStep), now.speed, 1e-6) << t;
    EXPECT_NEAR((after.speed - before.speed) / (2.0 * kStep), now.acceleration, 1e-4) << t;
    EXPECT_LE(std::fabs(now.acceleration), rates.acceleration * (1.0 + 1e-12)) << t;
  }
  EXPECT_NEAR(profile.at(19.0).speed, 0.0, 1e-15);
}

// There and back within ramps: 0.5 m/s for 10 s between the ramps' middles, then as long the other way at half the speed.
TEST(Motion, KnowsHowFarItGoes) {
  const MotionProfile profile({.top_speed = 0.5, .acceleration = 0.25}, {{2 * kSecond, 1.0}, {12 * kSecond, -0.5}, {22 * kSecond, 0.0}});
  EXPECT_EQ(profile.least(60.0), 0.0);
  // The turn lies in the ramp from 0.5 to -0.25 m/s, 4.5 s long: at 3 s^2 - 2 s^3 = 2/3.
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 60; ++i) {
    const double s = 0.5 * (low + high);
    (3.0 * s * s - 2.0 * s * s * s < 2.0 / 3.0 ? low : high) = s;
  }
  const double turn = 0.5 * 8.5 + 4.5 * (0.5 * low - 0.75 * (low * low * low - 0.5 * low * low * low * low));
  EXPECT_NEAR(profile.largest(60.0), turn, 1e-6);
  EXPECT_NEAR(profile.largest(10.0), 0.5 * 6.5, 1e-12);
}

}  // namespace
}  // namespace slewlab::sim
