#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// (2.17)
TEST(RopeLength, SetsThePeriod) {
  const auto samples = run(pendulum(), "rope_length", {1.2}, 80.0, no_drive, {.rope_angle = 0.02});
  const double period = period_of(samples, [](const BenchSample& s) { return s.rope_angle; });
  EXPECT_NEAR(period, 2.0 * std::numbers::pi * std::sqrt(72.0 / 9.81), 1e-5);
}

}  // namespace
}  // namespace slewlab::sim
