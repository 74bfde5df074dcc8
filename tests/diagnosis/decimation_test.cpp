#include "diagnosis/decimation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace slewlab::diagnosis {
namespace {

constexpr double kStep = 0.001;  // [s]

// Largest size in the middle of 4 s of a sine at 1 kHz, every tenth value of it taken.
double size_after(double frequency) {
  std::vector<double> series;
  for (int n = 0; n < 4000; ++n) series.push_back(std::sin(2.0 * std::numbers::pi * frequency * kStep * n + 0.3));
  const std::vector<double> taken = decimated(series, 10);
  EXPECT_EQ(taken.size(), 400u);
  double size = 0.0;
  for (std::size_t n = 50; n < 350; ++n) size = std::max(size, std::fabs(taken[n]));
  return size;
}

// 95 and 105 Hz at 100 Hz would be a line at 5 Hz, 81 Hz one at 19 Hz: the whole of them where nothing filters.
TEST(Decimation, WhatTheNewRateCannotCarryDoesNotFoldBack) {
  for (const double frequency : {81.0, 95.0, 105.0, 188.0, 410.0}) EXPECT_LT(size_after(frequency), 1e-3) << frequency;
}

TEST(Decimation, WhatThePageShowsKeepsItsSize) {
  for (const double frequency : {0.2, 1.3, 5.2, 20.0}) EXPECT_NEAR(size_after(frequency), 1.0, 0.01) << frequency;
}

TEST(Decimation, ShiftsNothingInTime) {
  std::vector<double> line;
  for (int n = 0; n < 2000; ++n) line.push_back(0.5 * n - 100.0);
  const std::vector<double> taken = decimated(line, 10);
  for (std::size_t n = 10; n < 190; ++n) EXPECT_NEAR(taken[n], line[10 * n], 1e-9);
}

TEST(Decimation, ConstantsStayToTheEndsAndBesideHoles) {
  std::vector<double> series(1000, 3.0);
  series[500] = series[503] = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> taken = decimated(series, 10);
  ASSERT_EQ(taken.size(), 100u);
  for (std::size_t n = 0; n < taken.size(); ++n) {
    if (n == 50) {
      EXPECT_TRUE(std::isnan(taken[n]));
    } else {
      EXPECT_NEAR(taken[n], 3.0, 1e-12) << n;
    }
  }
}

// A line that begins where the series does: a window with more on one side would have shifted it.
TEST(Decimation, ALineKeepsToItsEnds) {
  std::vector<double> line;
  for (int n = 0; n < 201; ++n) line.push_back(0.5 * n);
  const std::vector<double> taken = decimated(line, 10);
  for (std::size_t n = 0; n < taken.size(); ++n) EXPECT_NEAR(taken[n], line[10 * n], 1e-9);
}

// Held for 1 ms each, and for 5 or 4 ms each: an inertia comes to the same places, to 0.2 % of a sine's own in it, 1 / (2 pi f)^2.
TEST(Decimation, WhatIsHeldBringsAnInertiaToTheSamePlaces) {
  for (const std::size_t stride : {4U, 5U}) {
    for (const double frequency : {1.0, 10.0, 25.0, 40.0}) {
      const auto value = [&](double time) { return std::sin(2.0 * std::numbers::pi * frequency * time); };
      std::vector<double> held;
      for (int n = 0; n < 6000; ++n) held.push_back(value(kStep * n));
      const std::vector<double> longer = held_decimated(held, stride);
      ASSERT_EQ(longer.size(), 6000 / stride);
      const double step = kStep * static_cast<double>(stride);
      struct Inertia {
        double place = 0.0, speed = 0.0;
        void go(double torque, double time) {
          place += time * speed + 0.5 * time * time * torque;
          speed += time * torque;
        }
      } one, other;
      std::vector<double> apart;
      for (std::size_t n = 0; n < longer.size(); ++n) {
        for (std::size_t k = 0; k < stride; ++k) one.go(held[stride * n + k], kStep);
        other.go(longer[n], step);
        apart.push_back(one.place - other.place);
      }
      // Behind the beginning, where the window is short, what it made of speed and place: the line through two moments of one phase.
      const std::size_t first = 200, last = first + static_cast<std::size_t>(std::lround(4.0 / step)), whole = last - first;
      const double slope = (apart[last] - apart[first]) / static_cast<double>(whole);
      for (std::size_t n = first; n < last; ++n) {
        const double left = apart[n] - apart[first] - slope * static_cast<double>(n - first);
        ASSERT_LT(std::fabs(left), 2e-3 * std::pow(2.0 * std::numbers::pi * frequency, -2.0)) << frequency << " Hz, " << stride;
      }
    }
  }
}

TEST(Decimation, MeansKeepTheBitsOfWhatHolds) {
  EXPECT_EQ(means({0.1, 0.1, 0.1, 2.0, 4.0, 6.0, 5.0}, 3), (std::vector<double>{0.1, 4.0, 5.0}));
}

TEST(Decimation, AStrideOfOneIsTheSeries) {
  const std::vector<double> series{1.0, -2.0, 7.0};
  EXPECT_EQ(decimated(series, 1), series);
  EXPECT_EQ(held_decimated(series, 1), series);
}

}  // namespace
}  // namespace slewlab::diagnosis
