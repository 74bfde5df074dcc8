#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "sim/machine/machine_file.h"
#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// Period of the pendulum by its series in the amplitude b: 1 + b^2/16 + 11 b^4/3072 + 173 b^6/737280.
TEST(LargeAngles, LengthenThePeriod) {
  constexpr double kAmplitude = 0.6;  // [rad]
  const auto samples =
      run(pendulum(), "large_angles", {1.0}, 100.0, no_drive, {.rope_angle = std::sin(kAmplitude)});
  const double b2 = kAmplitude * kAmplitude;
  const double series = 1.0 + b2 / 16.0 + 11.0 * b2 * b2 / 3072.0 + 173.0 * b2 * b2 * b2 / 737280.0;
  const double period = period_of(samples, [](const BenchSample& s) { return s.rope_angle; });
  EXPECT_NEAR(period / (2.0 * std::numbers::pi * std::sqrt(60.0 / 9.81)), series, 1e-5);
}

// [rad], [rad/s] of rope and rod.
using Swing = std::array<double, 4>;

// Lagrange's equations of a uniform rod (length l) on a rope (length L) in angles, divided by the mass:
//   L^2 b_1'' + L l/2 cos(b_1 - b_2) b_2'' = -L l/2 sin(b_1 - b_2) b_2'^2 - g L sin(b_1)
//   L l/2 cos(b_1 - b_2) b_1'' + l^2/3 b_2'' = L l/2 sin(b_1 - b_2) b_1'^2 - g l/2 sin(b_2)
Swing slope(const Swing& at, double rope, double rod) {
  const auto [b1, b2, v1, v2] = at;
  const double m11 = rope * rope, m12 = 0.5 * rope * rod * std::cos(b1 - b2), m22 = rod * rod / 3.0, turn = 0.5 * rope * rod * std::sin(b1 - b2);
  const double q1 = -turn * v2 * v2 - kGravity * rope * std::sin(b1), q2 = turn * v1 * v1 - 0.5 * kGravity * rod * std::sin(b2);
  const double determinant = m11 * m22 - m12 * m12;
  return {v1, v2, (m22 * q1 - m12 * q2) / determinant, (m11 * q2 - m12 * q1) / determinant};
}

// Runge and Kutta's step of fourth order.
Swing stepped(const Swing& at, double h, double rope, double rod) {
  const auto ahead = [&](double by, const Swing& along) {
    Swing result = at;
    for (std::size_t i = 0; i < at.size(); ++i) result[i] += by * along[i];
    return result;
  };
  const Swing k1 = slope(at, rope, rod), k2 = slope(ahead(0.5 * h, k1), rope, rod), k3 = slope(ahead(0.5 * h, k2), rope, rod), k4 = slope(ahead(h, k3), rope, rod);
  Swing result = at;
  for (std::size_t i = 0; i < at.size(); ++i) result[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
  return result;
}

// On a house that stays where it is; the rod a sixth of the rope, so that what it does at large angles counts. The start has both extensions alike.
TEST(LargeAngles, AreTheDoublePendulums) {
  constexpr double kRope = 30.0, kRod = 5.0, kStart = 0.5;  // [m], [m], sine
  CraneParameters crane = pendulum(30e3, kRope);
  crane.load.rod_length = kRod;
  const auto samples = run(crane, "large_angles", {1.0}, 30.0, no_drive, {.rope_angle = kStart});
  Swing exact{std::asin(kStart), std::asin(kStart), 0.0, 0.0};
  double largest = 0.0;
  for (const BenchSample& sample : samples) {
    exact = stepped(exact, 1e-3, kRope, kRod);
    largest = std::max(largest, std::fabs(exact[0] - exact[1]));
    ASSERT_NEAR(sample.rope_angle, std::sin(exact[0]), 1e-4) << sample.time;
    ASSERT_NEAR(sample.rod_angle, std::sin(exact[1]), 1e-4) << sample.time;
  }
  EXPECT_GT(largest, 0.02);  // the rod did not just follow the rope
}

// A load that swings far holds its end of the boom as M sin(beta)^2 would, more than the boom's faster modes weigh there (three to eleven times on these
// cranes, at 0.3 rad). With a step a fifth as long the tip is led along five times faster; what a load does with its boom is the same.
TEST(LargeAngles, FeedNoModeOfALightBoom) {
  const auto swing = [](const std::string& crane, double step) {
    MachineSettings settings;
    settings.crane = load_machine_file(std::string(SLEWLAB_SOURCE_DIR) + "/config/cranes/" + crane + ".yaml").parameters;
    settings.step = step;
    settings.effects = {{"large_angles", {1.0}}};
    return run(settings, 60.0, no_drive, {.rope_angle = 0.3});
  };
  for (const char* crane : {"thesis", "harbour_5t", "offshore_900t"}) {
    const std::vector<BenchSample> coarse = swing(crane, 1e-3), fine = swing(crane, 2e-4);
    for (std::size_t k = 0; k < coarse.size(); ++k) {
      ASSERT_NEAR(coarse[k].rope_angle, fine[5 * k + 4].rope_angle, 3e-3) << crane << " at " << coarse[k].time;
    }
  }
}

}  // namespace
}  // namespace slewlab::sim
