#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// A load carried round at a steady speed, seen from outside: with z = x + i y, z'' = -w^2 (z - r e^(i o t))
// has the solution A e^(i o t) + B cos(w t) + C sin(w t). Its lag behind the tip, r arg(z) - r o t, is what
// the effect's centrifugal and Coriolis terms must give; they are right to first order of u / r, here 3 %.
TEST(Offlead, LagsAsSeenFromOutside) {
  const CraneParameters crane = pendulum();
  constexpr double kSlew = 0.05;
  const double r = crane.boom.pivot_radius + crane.boom.length * std::cos(crane.boom.angle);
  const double w = std::sqrt(9.81 / 60.0);
  const auto samples = run(crane, "offlead", {1.0}, 30.0, no_drive, {.slew_speed = kSlew});
  const double a = r * w * w / (w * w - kSlew * kSlew);
  double largest = 0.0;
  for (const BenchSample& s : samples) {
    const double t = s.time;
    const std::complex<double> z = a * std::polar(1.0, kSlew * t) + (r - a) * std::cos(w * t) +
                                   std::complex<double>(0.0, kSlew * (r - a) / w) * std::sin(w * t);
    const double expected = r * (std::arg(z) - kSlew * t);
    EXPECT_NEAR(s.load_displacement - s.tip_displacement, expected, 0.01) << t;
    largest = std::max(largest, std::fabs(expected));
  }
  EXPECT_GT(largest, 0.1) << "the bound above must be small against the motion";
}

}  // namespace
}  // namespace slewlab::sim
