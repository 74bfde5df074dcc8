#include "sim/effects/ripple.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

namespace slewlab::sim {
namespace {

// The integral of both sines over the turned angle, in closed form.
TEST(Ripple, IsTheMeanOfBothHarmonics) {
  const Ripple ripple{.order = 3.0, .phase = 0.7, .second_sine = 0.4, .second_cosine = -0.2};
  const double from = 0.2, to = 0.9;
  const auto integral = [&](double at) {
    return -std::cos(3.0 * at + 0.7) / 3.0 + (-0.4 * std::cos(6.0 * at) - 0.2 * std::sin(6.0 * at)) / 6.0;
  };
  EXPECT_NEAR(mean_ripple(wave_of(ripple), 0.5 * (from + to), to - from), (integral(to) - integral(from)) / (to - from), 1e-14);
}

// sin(h) / h of the wave in the middle; the phase is apart from the angle, as in sin(a + b): the same but for what is rounded.
TEST(Ripple, WithoutSecondHarmonicIsTheMeanSine) {
  const RippleWave wave = wave_of({.order = 3.0, .phase = 0.7, .second_sine = 0.0, .second_cosine = 0.0});
  for (const double angle : {-2.0, 0.0, 0.31, 7.0}) {
    EXPECT_NEAR(mean_ripple(wave, angle, 0.05), std::sin(3.0 * angle + 0.7) * std::sin(0.075) / 0.075, 1e-15);
  }
}

// (1 + s) and (1 - s) of the wave; the middle group of an odd number has the mean.
TEST(Ripple, OfAHalfAloneIsSilentInTheOther) {
  const Ripple ripple{.order = 3.0, .phase = 0.7, .second_sine = 0.4, .second_cosine = -0.2};
  const double whole = mean_ripple(wave_of(ripple), 0.31, 0.05);
  const GroupRipples alone = ripples_of_groups(ripple, {.phase_last = 0.7, .share = 1.0}, 2);
  EXPECT_NEAR(mean_ripple(alone[0], 0.31, 0.05), 2.0 * whole, 1e-15);
  EXPECT_EQ(mean_ripple(alone[1], 0.31, 0.05), 0.0);
  const GroupRipples odd = ripples_of_groups(ripple, {.phase_last = 0.7, .share = 0.25}, 3);
  for (const auto& [group, factor] : {std::pair{0, 1.25}, std::pair{1, 1.0}, std::pair{2, 0.75}}) {
    EXPECT_NEAR(mean_ripple(odd[static_cast<std::size_t>(group)], 0.31, 0.05), factor * whole, 1e-15) << group;
  }
}

}  // namespace
}  // namespace slewlab::sim
