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
  const auto samples = run(pendulum(), "hoisting", {0.5, 5.0, 60.0, 1.0, 1.0}, 140.0, no_drive, {.rope_angle = 0.02});
  const std::vector<BenchSample> after(samples.begin() + 66000, samples.end());
  const double period = period_of(after, [](const BenchSample& s) { return s.load_displacement; });
  EXPECT_NEAR(period, 2.0 * std::numbers::pi * std::sqrt(30.5 / 9.81), 1e-4);
  double amplitude = 0.0;
  for (const BenchSample& s : after) amplitude = std::max(amplitude, s.load_displacement);
  EXPECT_NEAR(amplitude / (0.02 * 60.0), std::pow(30.5 / 60.0, 0.25), 0.01);
}

// A pendulum held out by x feels M (g + s'') x / L: the hoisted speed's largest jerk, 6 v / t_r^2 where a ramp begins and ends, is all
// that the load's acceleration may change by, beside the slow M g s' x / L^2.
TEST(Hoisting, RoundedHasNoStepsOfAcceleration) {
  constexpr double kSpeed = 0.5, kRamp = 1.0, kRope = 60.0, kStep = 1e-3;  // [m/s], [s], [m], [s]
  const auto samples = run(pendulum(), "hoisting", {kSpeed, 1.0, 8.0, kRamp, 1.0}, 10.0, no_drive, {.rope_angle = 0.02});
  const double displacement = 0.02 * kRope;  // [m]
  const double jerk = 6.0 * kSpeed / (kRamp * kRamp) * displacement / kRope;
  const double shorter_rope = 9.81 * kSpeed * displacement / ((kRope - 4.0) * (kRope - 4.0));
  const double swing = std::pow(9.81 / (kRope - 4.0), 1.5) * displacement;
  double largest = 0.0;
  for (std::size_t n = 2; n < samples.size(); ++n) {
    const double change = samples[n].load_velocity - 2.0 * samples[n - 1].load_velocity + samples[n - 2].load_velocity;
    largest = std::max(largest, std::fabs(change) / (kStep * kStep));
  }
  EXPECT_LT(largest, 1.05 * (jerk + shorter_rope + swing));
  EXPECT_GT(largest, 0.5 * jerk);
}

// A ramp of which the share r is rounded has the acceleration v / (t_r (1 - r / 3)) in its middle, and the load there that of M (g + s'') x / L. Where nothing is rounded that is
// there from its first moment on.
TEST(Hoisting, LinearBeginsWithAStepOfAcceleration) {
  constexpr double kSpeed = 0.5, kRamp = 1.0, kBegin = 1.0, kRope = 60.0;  // [m/s], [s], [s], [m]
  const auto unhoisted = run(MachineSettings{.crane = pendulum(), .effects = {}}, 2.5, no_drive, {.rope_angle = 0.02});
  for (const double rounding : {0.0, 0.3, 1.0}) {
    const auto samples = run(pendulum(), "hoisting", {kSpeed, kBegin, 8.0, kRamp, rounding}, 2.5, no_drive, {.rope_angle = 0.02});
    // [m/s^2] that the load is pulled in by more, between two moments [s]; the rope that is shorter by then takes g s / L^2.
    const auto pulled = [&](double from, double to) {
      const auto first = static_cast<std::size_t>(std::lround(from * 1e3)), last = static_cast<std::size_t>(std::lround(to * 1e3));
      const double gained = (samples[last].load_velocity - unhoisted[last].load_velocity) - (samples[first].load_velocity - unhoisted[first].load_velocity);
      return -gained / (to - from);
    };
    const double at_first = unhoisted[1000].load_displacement, displacement = unhoisted[1500].load_displacement;  // [m]
    const double shorter_rope = 9.81 * 0.125 * kSpeed * displacement / (kRope * kRope);  // s = v t_r / 8 in a linear ramp's middle
    const double middle = kSpeed / (kRamp * (1.0 - rounding / 3.0)) * displacement / kRope;
    EXPECT_NEAR(pulled(1.49, 1.51), middle + shorter_rope, 0.04 * middle) << rounding;  // the load has come in a little by then
    EXPECT_NEAR(pulled(1.0, 1.01), rounding == 0.0 ? kSpeed / kRamp * at_first / kRope : 0.0, (rounding == 0.0 ? 0.01 : 0.15) * middle) << rounding;
  }
}

TEST(Hoisting, ChangesNothingBeforeItBegins) {
  const auto with = run(pendulum(), "hoisting", {0.5, 5.0, 60.0, 1.0, 1.0}, 4.9, no_drive, {.rope_angle = 0.02});
  const auto without =
      run(MachineSettings{.crane = pendulum(), .effects = {}}, 4.9, no_drive, {.rope_angle = 0.02});
  EXPECT_EQ(with.back().load_displacement, without.back().load_displacement);
}

}  // namespace
}  // namespace slewlab::sim
