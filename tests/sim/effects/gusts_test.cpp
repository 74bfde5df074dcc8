#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "sim/effects/effect.h"
#include "sim/integrate/machine.h"
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

// [-] of a first-order filter's noise between 0.01 and 5 Hz; of all frequencies it would be exp(-lag / correlation_time).
double correlation(double lag, double correlation_time) {
  double product = 0.0, square = 0.0;
  constexpr double kStep = 1e-3;  // [Hz]
  for (int n = 0; n < 4990; ++n) {
    const double omega = 2.0 * std::numbers::pi * (0.01 + (n + 0.5) * kStep);
    const double power = 1.0 / (1.0 + omega * omega * correlation_time * correlation_time);
    product += power * std::cos(omega * lag);
    square += power;
  }
  return product / square;
}

TEST(Gusts, FadeWithTheirCorrelationTime) {
  constexpr double kStep = 0.02, kCorrelationTime = 5.0;
  const auto pressure = pressures(kStep, 4000.0, 3);
  double mean = 0.0, square = 0.0;
  for (const double p : pressure) mean += p / static_cast<double>(pressure.size());
  for (const double p : pressure) square += (p - mean) * (p - mean) / static_cast<double>(pressure.size());
  for (const double lag : {0.5, 2.0, 5.0}) {
    const auto steps = static_cast<std::size_t>(std::lround(lag / kStep));
    double product = 0.0;
    for (std::size_t n = steps; n < pressure.size(); ++n) product += (pressure[n] - mean) * (pressure[n - steps] - mean);
    product /= static_cast<double>(pressure.size() - steps);
    EXPECT_NEAR(product / square, correlation(lag, kCorrelationTime), 0.03) << lag;
  }
}

// The wind is a function of time and seed alone: the middle of the first 10 ms is that of the third 2 ms.
TEST(Gusts, AreTheSameAtEveryStepLength) {
  const auto coarse = pressures(0.010, 0.02, 3);
  const auto fine = pressures(0.002, 0.02, 3);
  EXPECT_NEAR(coarse[0], fine[2], 1e-6 * std::fabs(coarse[0]));
  EXPECT_NE(pressures(0.010, 0.02, 4)[0], coarse[0]);
}

// Asked at a moment for the first time, after a long way in even steps, and again after others: the same gust. Nothing is known of the moment of a first call.
TEST(Gusts, AreThoseOfTheMomentWhateverWasAskedBefore) {
  const Machine machine = make_machine({.crane = fixed_house()});
  const std::vector<double> values{kDeviation, kMean, std::numbers::pi / 2.0, 5.0, 80.0, 20.0};
  const auto pressure_at = [](RunningEffect& effect, double time) {
    EffectMoment moment;
    moment.time = time;
    PortForces ports;
    effect.force(moment, ports);
    return ports.uniform_force;
  };
  constexpr double kStep = 1e-3;  // [s]
  const auto walking = started("gusts", values, machine.model, 3);
  const double beginning = pressure_at(*walking, 0.0);
  EXPECT_NE(beginning, 0.0);
  EXPECT_EQ(pressure_at(*walking, 0.0), beginning);
  for (int n = 0; n <= 5500; ++n) {
    const double time = kStep * (n + 0.5), walked = pressure_at(*walking, time);
    if (n % 500 != 0) continue;
    const auto fresh = started("gusts", values, machine.model, 3);
    EXPECT_NEAR(walked, pressure_at(*fresh, time), 1e-9 * std::fabs(walked) + 1e-9) << time;
  }
  EXPECT_EQ(pressure_at(*walking, 0.0), beginning);
}

}  // namespace
}  // namespace slewlab::sim
