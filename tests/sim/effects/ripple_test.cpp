#include "sim/effects/ripple.h"

#include <gtest/gtest.h>

#include <cmath>

namespace slewlab::sim {
namespace {

// The integral of both sines over the turned angle, in closed form.
TEST(Ripple, IsTheMeanOfBothHarmonics) {
  const Ripple ripple{.order = 3.0, .phase = 0.7, .second_sine = 0.4, .second_cosine = -0.2};
  const double from = 0.2, to = 0.9;
  const auto integral = [&](double at) {
    return -std::cos(3.0 * at + 0.7) / 3.0 + (-0.4 * std::cos(6.0 * at) - 0.2 * std::sin(6.0 * at)) / 6.0;
  };
  EXPECT_NEAR(mean_ripple(ripple, 0.5 * (from + to), to - from), (integral(to) - integral(from)) / (to - from), 1e-14);
}

// To the bit: effects without it stay what they were.
TEST(Ripple, WithoutSecondHarmonicIsTheMeanSine) {
  const Ripple ripple{.order = 3.0, .phase = 0.7, .second_sine = 0.0, .second_cosine = 0.0};
  for (const double angle : {-2.0, 0.0, 0.31, 7.0}) {
    EXPECT_EQ(mean_ripple(ripple, angle, 0.05), mean_sine(3.0 * angle + 0.7, 3.0 * 0.05));
  }
}

}  // namespace
}  // namespace slewlab::sim
