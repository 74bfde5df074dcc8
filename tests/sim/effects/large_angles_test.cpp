#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

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

}  // namespace
}  // namespace slewlab::sim
