#include "diagnosis/record.h"

#include <gtest/gtest.h>

#include <cmath>

namespace slewlab::diagnosis {
namespace {

// The fit is a cubic, so the slope of a cubic is exact, at the ends (two values) only as good as a difference.
TEST(CubicSlope, IsExactOnACubic) {
  constexpr double kStep = 0.01;  // [s]
  std::vector<double> values, slope;
  for (int n = 0; n < 100; ++n) {
    const double t = kStep * n;
    values.push_back(1.0 - 2.0 * t + 3.0 * t * t - 4.0 * t * t * t);
    slope.push_back(-2.0 + 6.0 * t - 12.0 * t * t);
  }
  const std::vector<double> found = cubic_slope(values, 6, kStep);
  for (std::size_t n = 2; n + 2 < values.size(); ++n) EXPECT_NEAR(found[n], slope[n], 1e-10) << n;
  EXPECT_NEAR(found[0], slope[0], 0.05);
}

// Without delay: the slope of a sine is a cosine in phase, a little small (the fit's next term, of fourth order).
TEST(CubicSlope, IsNotLate) {
  constexpr double kStep = 1e-3, kOmega = 2.0 * M_PI * 40.0;
  std::vector<double> values;
  for (int n = 0; n < 1000; ++n) values.push_back(std::sin(kOmega * kStep * n) / kOmega);
  const std::vector<double> found = cubic_slope(values, 6, kStep);
  for (std::size_t n = 6; n + 6 < values.size(); ++n) {
    EXPECT_NEAR(found[n], std::cos(kOmega * kStep * static_cast<double>(n)), 0.03) << n;
  }
}

}  // namespace
}  // namespace slewlab::diagnosis
