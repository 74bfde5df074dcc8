#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// Quadratic drag on a swing, averaged over a cycle: 1/a(t) = 1/a_0 + 4 k w t / (3 pi M), k = rho C A / 2.
TEST(AirDrag, TakesAmplitudeByTheQuadraticLaw) {
  const auto samples = run(pendulum(), "air_drag", {200.0}, 160.0, no_drive, {.rope_angle = 0.1});
  const double frequency = std::sqrt(9.81 / 60.0);
  double amplitude = 0.0, at = 0.0;
  for (const BenchSample& s : samples) {
    if (s.time > 148.0 && s.load_displacement > amplitude) {
      amplitude = s.load_displacement;
      at = s.time;
    }
  }
  const double k = 0.5 * 1.225 * 200.0;
  const double expected = 1.0 / (1.0 / 6.0 + 4.0 * k * frequency * at / (3.0 * std::numbers::pi * 30e3));
  EXPECT_NEAR(amplitude, expected, 2e-3 * expected);
}

}  // namespace
}  // namespace slewlab::sim
