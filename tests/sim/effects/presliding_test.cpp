#include "sim/effects/presliding.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>

namespace slewlab::sim {
namespace {

constexpr double kGive = 3e-5;  // [rad]

// Share at the end of a path from rest at 0, by its corners [give], each side in `steps` steps.
double along(std::initializer_list<double> corners, int steps = 100) {
  Presliding joint{.give = kGive};
  double at = 0.0, share = presliding_share(joint, 0.0);
  for (const double corner : corners) {
    for (int k = 1; k <= steps; ++k) share = presliding_share(joint, kGive * (at + (corner - at) * k / steps));
    at = corner;
  }
  return share;
}

// Solutions of ds/dx = (1 - s sign(dx)) / give.
TEST(Presliding, IsDahlsLawExactly) {
  for (const double x : {0.01, 0.3, 1.0, 2.5, 7.0}) {
    EXPECT_NEAR(along({x}), 1.0 - std::exp(-x), 1e-12) << x;
    EXPECT_NEAR(along({-x}), std::exp(-x) - 1.0, 1e-12) << x;
    EXPECT_NEAR(along({50.0, 50.0 - x}), -1.0 + 2.0 * std::exp(-x), 1e-12) << x;
    EXPECT_NEAR(along({-50.0, -50.0 + x}), 1.0 - 2.0 * std::exp(-x), 1e-12) << x;
  }
  EXPECT_EQ(along({50.0}, 1), 1.0);
}

TEST(Presliding, DoesNotDependOnTheStep) {
  for (const int steps : {2, 7, 1000}) {
    EXPECT_NEAR(along({1.3, 0.4, 0.9, -2.0}, steps), along({1.3, 0.4, 0.9, -2.0}, 1), 1e-12) << steps;
  }
}

// Motions of many sizes both ways, from a hundred millionth of the give to a hundred million times.
TEST(Presliding, NeverHoldsMoreThanItsLevel) {
  Presliding joint{.give = kGive};
  double angle = 0.0;
  for (int n = 0; n < 10000; ++n) {
    angle += kGive * std::sin(1.7 * n) * std::pow(10.0, 8.0 * std::sin(0.37 * n));
    EXPECT_LE(std::fabs(presliding_share(joint, angle)), 1.0);
  }
}

// Where the joint has not moved it holds what it held.
TEST(Presliding, HoldsAtRest) {
  Presliding joint{.give = kGive};
  presliding_share(joint, 0.0);
  const double share = presliding_share(joint, kGive);
  for (int n = 0; n < 10; ++n) EXPECT_EQ(presliding_share(joint, kGive), share);
}

// Back and forth by d from s: s - s* is multiplied by exp(-2 d / give), s* = tanh(d / (2 give)) being the upper end of
// the loop about zero.
TEST(Presliding, CreepsTowardsTheLoopAboutZero) {
  constexpr double kSwing = 0.1;
  Presliding joint{.give = 1.0};
  presliding_share(joint, 0.0);
  const double start = presliding_share(joint, 1.0), end = std::tanh(0.5 * kSwing);
  for (int n = 1; n <= 40; ++n) {
    presliding_share(joint, 1.0 - kSwing);
    EXPECT_NEAR(presliding_share(joint, 1.0) - end, (start - end) * std::exp(-2.0 * kSwing * n), 1e-12) << n;
  }
}

// The work of the loop between -A and A, the integral of s dx: 4 (A - tanh A) in units of the give.
TEST(Presliding, LosesTheWorkOfItsLoops) {
  for (const double amplitude : {0.15, 0.8, 3.0, 10.0}) {
    Presliding joint{.give = 1.0};
    constexpr int kSteps = 2000, kLead = 80;  // cycles that lead into the loop
    double work = 0.0, before = 0.0, held = presliding_share(joint, 0.0);
    for (int n = 1; n <= kSteps * (kLead + 1); ++n) {
      const double angle = amplitude * std::sin(2.0 * std::numbers::pi * n / kSteps);
      const double share = presliding_share(joint, angle);
      if (n > kSteps * kLead) work += 0.5 * (held + share) * (angle - before);
      before = angle;
      held = share;
    }
    const double expected = 4.0 * (amplitude - std::tanh(amplitude));
    EXPECT_NEAR(work, expected, 1e-4 * std::max(1.0, expected)) << amplitude;
  }
}

}  // namespace
}  // namespace slewlab::sim
