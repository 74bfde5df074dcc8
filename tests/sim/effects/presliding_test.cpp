#include "sim/effects/presliding.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>

namespace slewlab::sim {
namespace {

constexpr double kGive = 3e-5;  // [rad]

// Share at the end of a path from rest at 0, by its corners [give], in steps of a hundredth.
double along(std::initializer_list<double> corners) {
  Presliding joint{.give = kGive};
  double at = 0.0, share = presliding_share(joint, 0.0);
  for (const double corner : corners) {
    const int steps = std::max(1, static_cast<int>(std::lround(100.0 * std::fabs(corner - at))));
    for (int k = 1; k <= steps; ++k) share = presliding_share(joint, kGive * (at + (corner - at) * k / steps));
    at = corner;
  }
  return share;
}

TEST(Presliding, FollowsDahlsCurveFromRest) {
  double worst = 0.0;
  for (double x = 0.005; x < 8.0; x += 0.005) {
    worst = std::max(worst, std::fabs(along({x}) - (1.0 - std::exp(-x))));
    EXPECT_NEAR(along({-x}), -along({x}), 1e-12);
  }
  EXPECT_LT(worst, 0.018);
  EXPECT_NEAR(along({0.01}), 0.01, 1e-5);  // the first stiffness is level / give
}

TEST(Presliding, SlidesAtItsLevelExactly) {
  EXPECT_EQ(along({4.1}), 1.0);
  EXPECT_EQ(along({-4.1}), -1.0);
  EXPECT_EQ(along({50.0, 40.0}), -1.0);
  EXPECT_LT(along({4.0}), 1.0);
}

// Turned back it follows the curve from rest, twice as large, whether it has slid in full or not.
TEST(Presliding, TurnsBackByMasingsRule) {
  for (const double turn : {0.6, 1.5, 6.0}) {
    for (const double back : {0.1, 0.5, 1.0, 1.2}) {
      EXPECT_NEAR(along({turn, turn - back}), along({turn}) - 2.0 * along({0.5 * back}), 1e-12) << turn << " " << back;
    }
  }
  for (const double back : {0.5, 2.0, 5.0, 9.0}) {
    EXPECT_NEAR(along({6.0, 6.0 - back}), 1.0 - 2.0 * (1.0 - std::exp(-0.5 * back)), 2.0 * 0.018) << back;
  }
}

// An excursion that comes back to where it left closes, and leaves no trace on the way on.
TEST(Presliding, ClosesItsLoopsAndDoesNotDrift) {
  EXPECT_NEAR(along({2.0, 1.0, 2.0}), along({2.0}), 1e-12);
  EXPECT_NEAR(along({2.0, 1.0, 1.7, 1.2, 2.0, 3.0}), along({3.0}), 1e-12);
  Presliding joint{.give = kGive};
  double first = 0.0, last = 0.0;
  constexpr int kSteps = 500, kCycles = 2000;
  for (int n = 0; n <= kSteps * kCycles; ++n) {
    const double angle = kGive * (0.3 + 0.4 * std::sin(2.0 * std::numbers::pi * n / kSteps));
    last = presliding_share(joint, angle);
    if (n == kSteps) first = last;
  }
  EXPECT_NEAR(last, first, 1e-9);
}

// The work of a cycle that swings by A is the sum of 4 w_i (A - r_i give) over the elements that slide.
TEST(Presliding, LosesTheWorkOfItsLoops) {
  for (const double amplitude : {0.15, 0.8, 3.0, 10.0}) {
    Presliding joint{.give = 1.0};
    double work = 0.0, before = 0.0, expected = 0.0;
    constexpr int kSteps = 20000;
    for (int n = 0; n <= 2 * kSteps; ++n) {  // the second cycle counts, the first one leads into the loop
      const double angle = amplitude * std::sin(2.0 * std::numbers::pi * n / kSteps);
      const double share = presliding_share(joint, angle);
      if (n > kSteps) work += share * (angle - before);
      before = angle;
    }
    for (std::size_t i = 0; i < kPreslidingElements; ++i) {
      expected += 4.0 * kPreslidingShare[i] * std::max(0.0, amplitude - kPreslidingRatio[i]);
    }
    EXPECT_NEAR(work, expected, 2e-3 * std::max(1.0, amplitude)) << amplitude;
  }
}

}  // namespace
}  // namespace slewlab::sim
