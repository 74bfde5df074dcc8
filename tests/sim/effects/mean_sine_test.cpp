#include "sim/effects/mean_sine.h"

#include <gtest/gtest.h>

#include <numbers>

namespace slewlab::sim {
namespace {

// (cos a - cos b) / (b - a), also where the span is nearly nothing.
TEST(MeanSine, IsTheIntegralOverTheSpan) {
  for (const double turned : {1e-9, 1e-5, 1e-3, 0.3, 5.0, -0.7}) {
    const double from = 0.8 - 0.5 * turned, to = 0.8 + 0.5 * turned;
    const double exact =
        std::fabs(turned) > 1e-4 ? (std::cos(from) - std::cos(to)) / turned : std::sin(0.8);
    EXPECT_NEAR(mean_sine(0.8, turned), exact, 1e-11) << turned;
  }
}

TEST(MeanSine, AWholeTurnLeavesNothing) {
  EXPECT_NEAR(mean_sine(0.8, 2.0 * std::numbers::pi), 0.0, 1e-15);
}

}  // namespace
}  // namespace slewlab::sim
