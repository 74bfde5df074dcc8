#include "sim/effects/gusts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

constexpr double kMean = 20.0, kDeviation = 1.0;

// The pressure of the gusts [N/m^2] at the middle of each step, from the acceleration of a house that stands.
std::vector<double> pressures(double step, double duration, std::uint64_t seed) {
  const CraneParameters crane = fixed_house();
  const double centre = crane.boom.pivot_radius + 0.5 * crane.boom.length * std::cos(crane.boom.angle);
  const auto samples =
      run({.crane = crane,
           .effects = {{"gusts", {kDeviation, kMean, std::numbers::pi / 2.0, 5.0, 80.0, 20.0}}},
           .step = step,
           .seed = seed},
          duration);
  std::vector<double> result;
  for (const BenchSample& s : samples) {
    result.push_back(s.readings.house_acceleration / crane.house.sensor_radius *
                     house_and_boom_inertia(crane) / (80.0 * centre));
  }
  return result;
}

// Small gusts on a strong wind: pressure = rho v w, so its deviation is rho v sigma, its mean rho sigma^2
// / 2.
TEST(Gusts, HaveTheDeviationTheyAreGiven) {
  const auto pressure = pressures(0.02, 2000.0, 3);
  double mean = 0.0, square = 0.0;
  for (const double p : pressure) mean += p;
  mean /= static_cast<double>(pressure.size());
  for (const double p : pressure) square += (p - mean) * (p - mean);
  EXPECT_NEAR(mean, 0.5 * 1.225 * kDeviation * kDeviation, 0.5);
  EXPECT_NEAR(std::sqrt(square / static_cast<double>(pressure.size())), 1.225 * kMean * kDeviation, 1.0);
}

// The wind is a function of time and seed alone: the middle of the first 10 ms is that of the third 2 ms.
TEST(Gusts, AreTheSameAtEveryStepLength) {
  const auto coarse = pressures(0.010, 0.02, 3);
  const auto fine = pressures(0.002, 0.02, 3);
  EXPECT_NEAR(coarse[0], fine[2], 1e-6 * std::fabs(coarse[0]));
  EXPECT_NE(pressures(0.010, 0.02, 4)[0], coarse[0]);
}

}  // namespace
}  // namespace slewlab::sim
