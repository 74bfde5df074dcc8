#include "sim/effects/half_turn.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace slewlab::sim {
namespace {

// (cos a - cos b) / (b - a), also where the span is nearly nothing.
TEST(HalfTurn, GivesTheIntegralOverTheSpan) {
  for (const double turned : {1e-9, 1e-5, 1e-3, 0.3, 0.999, 1.001, 5.0, -0.7}) {
    const double from = 0.8 - 0.5 * turned, to = 0.8 + 0.5 * turned;
    const double exact =
        std::fabs(turned) > 1e-4 ? (std::cos(from) - std::cos(to)) / turned : std::sin(0.8);
    EXPECT_NEAR(std::sin(0.8) * half_turn(turned).share, exact, 1e-11) << turned;
  }
}

// Of the C library, on both sides of where the series ends.
TEST(HalfTurn, IsSineAndCosine) {
  for (const double half : {-0.5, -0.3, 1e-3, 0.1, 0.4999, 0.5, 0.5001, 3.0}) {
    EXPECT_NEAR(half_turn(2.0 * half).share, std::sin(half) / half, 2e-16) << half;
    EXPECT_NEAR(half_turn(2.0 * half).cosine, std::cos(half), 2e-16) << half;
  }
  EXPECT_EQ(half_turn(0.0).share, 1.0);
  EXPECT_EQ(half_turn(0.0).cosine, 1.0);
}

TEST(HalfTurn, AWholeTurnLeavesNothing) {
  EXPECT_NEAR(half_turn(2.0 * std::numbers::pi).share, 0.0, 1e-15);
}

}  // namespace
}  // namespace slewlab::sim
