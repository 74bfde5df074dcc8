#include "sim/effects/hoisting.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// 0.5 m/s for 60 s with ramps of 1 s: 29.5 m, as each ramp has half the speed on the average. Afterwards the period is the short rope's, and the amplitude
// has followed the adiabatic law of a slowly varying oscillator, x ~ L^(1/4).
TEST(Hoisting, EndsAsAShorterPendulum) {
  const auto samples = run(pendulum(), "hoisting", {0.5, 5.0, 60.0, 1.0}, 140.0, no_drive, {.rope_angle = 0.02});
  const std::vector<BenchSample> after(samples.begin() + 66000, samples.end());
  const double period = period_of(after, [](const BenchSample& s) { return s.load_displacement; });
  EXPECT_NEAR(period, 2.0 * std::numbers::pi * std::sqrt(30.5 / 9.81), 1e-4);
  double amplitude = 0.0;
  for (const BenchSample& s : after) amplitude = std::max(amplitude, s.load_displacement);
  EXPECT_NEAR(amplitude / (0.02 * 60.0), std::pow(30.5 / 60.0, 0.25), 0.01);
}

TEST(Hoisting, ChangesNothingBeforeItBegins) {
  const auto with = run(pendulum(), "hoisting", {0.5, 5.0, 60.0, 1.0}, 4.9, no_drive, {.rope_angle = 0.02});
  const auto without =
      run(MachineSettings{.crane = pendulum(), .effects = {}}, 4.9, no_drive, {.rope_angle = 0.02});
  EXPECT_EQ(with.back().load_displacement, without.back().load_displacement);
}

}  // namespace
}  // namespace slewlab::sim
