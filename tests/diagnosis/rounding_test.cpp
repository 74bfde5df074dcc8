#include "diagnosis/rounding.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace slewlab::diagnosis {
namespace {

constexpr double kStep = 0.1;

std::vector<double> noise(double deviation) {
  std::mt19937_64 engine(7);
  std::normal_distribution<double> normal(0.0, deviation);
  std::vector<double> values;
  for (int n = 0; n < 5000; ++n) values.push_back(normal(engine));
  return values;
}

std::vector<double> rounded(std::vector<double> values) {
  for (double& value : values) value = kStep * std::round(value / kStep);
  return values;
}

TEST(Rounding, IsFoundInWhatWasRounded) {
  const Rounding found = find_rounding(rounded(noise(3.0)), 100, 32);
  EXPECT_NEAR(found.step, kStep, 1e-9);
  EXPECT_FALSE(found.is_slow);
  EXPECT_NEAR(variance_of(found), kStep * kStep / 12.0, 1e-9);
}

// The least of 5000 changes is so small that every other one is a multiple of it to a few digits.
TEST(Rounding, IsNotFoundInWhatWasNot) { EXPECT_EQ(find_rounding(noise(3.0), 100, 2).step, 0.0); }

TEST(Rounding, IsSlowWhereValuesStay) {
  std::vector<double> values;
  for (int n = 0; n < 5000; ++n) values.push_back(2.0 * std::sin(2e-3 * n));  // changes by 0.004 at most
  const Rounding found = find_rounding(rounded(values), 10, 2);
  EXPECT_NEAR(found.step, kStep, 1e-9);
  EXPECT_TRUE(found.is_slow);
}

TEST(Rounding, OfASignalThatSwitchesBetweenFewLevelsThereIsNone) {
  std::vector<double> values;
  for (int n = 0; n < 5000; ++n) values.push_back(40.0 * (n / 10 % 4));
  EXPECT_EQ(find_rounding(values, 100, 32).step, 0.0);
  EXPECT_EQ(find_rounding(values, 100, 2).step, 40.0);
}

// 16384 counts a turn to 5 decimals: 0.00038 and 0.00039 rad, of a shaft that stands, crawls and runs.
TEST(Rounding, IsFoundInCountsThatWereWrittenToAFewDigits) {
  constexpr double kCount = 2.0 * 3.14159265358979 / 16384.0, kDigit = 1e-5;  // [rad]
  std::vector<double> values;
  for (int n = 0; n < 5000; ++n) {
    const double angle = 20.0 * std::pow(std::max(0, n - 1000) / 4000.0, 3);
    values.push_back(kDigit * std::round(kCount * std::round(angle / kCount) / kDigit));
  }
  EXPECT_NEAR(find_rounding(values, 100, 2).step / kCount, 1.0, 1e-3);
}

// By nearly the same amount every time, which a count of that size would do as well.
TEST(Rounding, IsNotFoundInWhatMovesSteadily) {
  std::vector<double> values;
  for (int n = 0; n < 5000; ++n) values.push_back(0.01 * n + 1e-4 * std::sin(0.5 * n));
  EXPECT_EQ(find_rounding(values, 100, 2).step, 0.0);
}

}  // namespace
}  // namespace slewlab::diagnosis
