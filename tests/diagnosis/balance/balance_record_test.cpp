// The filter against polynomials, which a cubic window differentiates exactly, and the noise estimates against the noise
// that was put in.
#include "diagnosis/balance/balance_record.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace slewlab::diagnosis {
namespace {

TEST(BalanceRecord, ACubicIsDifferentiatedExactly) {
  AxisRecord record{"cubic", 0.01, {}, {}};
  for (int n = 0; n < 400; ++n) {
    const double t = 0.01 * n;
    record.position.push_back(3.0 + 2.0 * t - t * t + 0.5 * t * t * t);
    record.effort.push_back(7.0);
  }
  const BalanceRecord balance = make_balance_record(record, 6);
  for (std::size_t n = 0; n < balance.time.size(); ++n) {
    const double t = balance.time[n];
    EXPECT_NEAR(balance.speed[n], 2.0 - 2.0 * t + 1.5 * t * t, 1e-9);
    EXPECT_NEAR(balance.acceleration[n], -2.0 + 3.0 * t, 1e-8);
    EXPECT_NEAR(balance.effort[n], 7.0, 1e-12);
  }
  EXPECT_EQ(balance_smoothed(balance.motion.speed, 6).size(), balance.speed.size());
}

// A free mass under a torque that is switched at any sample: position by hand, exact at the samples. Acceleration and effort pass one mean, so
// J q'' = F to rounding at every sample, also where the torque is switched inside the window.
TEST(BalanceRecord, ASwitchedTorqueBalancesToTheLastDigits) {
  constexpr double kStep = 0.01, kInertia = 3.0;
  AxisRecord record{"switched", kStep, {}, {}};
  double position = 0.2, speed = -0.1;
  for (int n = 0; n < 400; ++n) {
    const double effort = (n / 17) % 3 == 0 ? 5.0 : (n / 17) % 3 == 1 ? -4.0 : 1.0;
    record.position.push_back(position);
    record.effort.push_back(effort);
    position += speed * kStep + 0.5 * effort / kInertia * kStep * kStep;
    speed += effort / kInertia * kStep;
  }
  for (const std::size_t half : {3u, 6u, 11u}) {
    const BalanceRecord balance = make_balance_record(record, half);
    for (std::size_t n = 0; n < balance.time.size(); ++n) EXPECT_NEAR(kInertia * balance.acceleration[n], balance.effort[n], 1e-8) << half << " " << n;
  }
}

TEST(BalanceRecord, NoiseIsThatWhichWasPutIn) {
  std::mt19937_64 generator(7);
  std::normal_distribution<double> noise(0.0, 1e-3);
  std::vector<double> smooth, counted;
  for (int n = 0; n < 20000; ++n) {
    smooth.push_back(std::sin(1e-3 * n) + noise(generator));
    counted.push_back(0.02 * std::floor(std::sin(1e-3 * n) / 0.02));
  }
  EXPECT_NEAR(position_noise(smooth), 1e-3, 5e-5);                   // 20 000 values know a deviation to half a per cent
  EXPECT_NEAR(position_noise(counted), 0.02 / std::sqrt(12.0), 1e-4);  // evenly between two counts
}

// White noise of a measured torque; a torque that is switched now and then has none, however large its steps; one that was rounded has that of its
// step; and what becomes of it under the window is what the window makes of it.
TEST(BalanceRecord, NoiseOfTheEffortIsThatWhichWasPutIn) {
  constexpr double kNoise = 0.3;
  std::mt19937_64 generator(5);
  std::normal_distribution<double> noise(0.0, kNoise);
  std::vector<double> measured, switched, rounded, zeros(20000, 0.0), white;
  for (int n = 0; n < 20000; ++n) {
    white.push_back(noise(generator));
    measured.push_back(6.0 * std::sin(5e-3 * n) + white.back());
    switched.push_back((n / 40) % 2 == 0 ? 6.0 : -6.0);
    rounded.push_back(0.25 * std::round(6.0 * std::sin(5e-3 * n) / 0.25));
  }
  EXPECT_NEAR(effort_noise(measured), kNoise, 0.05 * kNoise);
  EXPECT_EQ(effort_noise(switched), 0.0);
  EXPECT_NEAR(effort_noise(rounded), 0.25 / std::sqrt(12.0), 1e-12);
  for (const std::size_t half : {3u, 9u}) {
    const BalanceRecord balance = make_balance_record({"noise", 0.01, zeros, white}, half);
    double square = 0.0;
    for (const double effort : balance.effort) square += effort * effort;
    // Half the square of its second differences, 3 kNoise^2 in the mean, counts as changes at an unknown instant: 1 + 3 / 12 of the square.
    EXPECT_NEAR(smoothed_effort_noise({"noise", 0.01, zeros, white}, half), std::sqrt(square / static_cast<double>(balance.effort.size()) * (1.0 + 3.0 / 12.0)), 0.05 * kNoise) << half;
  }
}

// What a lag, or a delay, withholds of white noise goes together with that noise: products of the filtered series, per sample, against sums over a long one.
TEST(BalanceRecord, ProductsOfTheEffortsNoiseAreThoseOfALongRecord) {
  constexpr double kStep = 0.01;
  const std::vector<Lateness> lateness{{0.02, false}, {0.1, false}, {0.034, true}};
  std::mt19937_64 generator(5);
  std::normal_distribution<double> noise(0.0, 1.0);
  AxisRecord record{"noise", kStep, std::vector<double>(60000, 0.0), {}};
  for (std::size_t n = 0; n < record.position.size(); ++n) record.effort.push_back(noise(generator));
  const BalanceRecord balance = make_balance_record(record, 5, lateness);
  std::vector<std::vector<double>> series{balance.effort};
  for (std::size_t k = 0; k < lateness.size(); ++k) {
    std::vector<double> withheld;
    for (std::size_t n = k; n < balance.motion.late.size(); n += lateness.size()) withheld.push_back(balance.motion.late[n]);
    series.push_back(balance_smoothed(withheld, 5));
  }
  const std::vector<double> products = effort_noise_products(kStep, 5, lateness);
  ASSERT_EQ(products.size(), 16u);
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      double sum = 0.0;
      for (std::size_t n = 0; n < series[i].size(); ++n) sum += series[i][n] * series[j][n];
      EXPECT_NEAR(sum / static_cast<double>(series[i].size()), products[4 * i + j], 0.05 * std::sqrt(products[5 * i] * products[5 * j])) << i << j;
    }
  }
}

// A ramp of 3 per second that comes 0.034 s late lacks 3 per second of it, between samples as well.
TEST(BalanceRecord, ADelayWithholdsWhatARampRisesByMeanwhile) {
  AxisRecord record{"ramp", 0.01, std::vector<double>(200, 0.0), {}};
  for (std::size_t n = 0; n < record.position.size(); ++n) record.effort.push_back(3.0 * record.step * static_cast<double>(n));
  const BalanceRecord balance = make_balance_record(record, 5, {{0.034, true}});
  for (std::size_t n = 10; n < balance.motion.late.size(); ++n) EXPECT_NEAR(balance.motion.late[n], 3.0, 1e-9) << n;
}

TEST(BalanceRecord, AWindowIsAsLongAsTheNoiseAsks) {
  AxisRecord quiet{"quiet", 1e-3, {}, {}};
  std::mt19937_64 generator(3);
  std::normal_distribution<double> noise(0.0, 1.0);
  for (int n = 0; n < 5000; ++n) {
    quiet.position.push_back(std::sin(2e-3 * n));
    quiet.effort.push_back(4.0 * std::sin(2e-3 * n));
  }
  AxisRecord noisy = quiet;
  for (double& position : noisy.position) position += 1e-5 * noise(generator);
  const std::size_t short_one = balance_half_window(quiet, 1.0, 0.5), long_one = balance_half_window(noisy, 1.0, 0.5);
  EXPECT_EQ(short_one, 3u);
  EXPECT_GT(long_one, 10u);
  // From the formula of the header, at the length that was chosen: noise hides below 2 % of the effort.
  const double n = 2.0 * static_cast<double>(long_one) + 1.0;
  EXPECT_LE(1e-5 * 1e6 * std::sqrt(720.0 / (n * (n * n - 1.0) * (n * n - 4.0))), 1.05 * 0.02 * 4.0 / std::sqrt(2.0));
  // Units do not matter: a thousand times heavier with a thousand times the effort.
  AxisRecord heavy = noisy;
  for (double& effort : heavy.effort) effort *= 1000.0;
  EXPECT_EQ(balance_half_window(heavy, 1000.0, 0.5), long_one);
}

TEST(BalanceRecord, ARecordTooShortIsRefused) {
  const AxisRecord record{"short", 0.01, std::vector<double>(20, 0.0), std::vector<double>(20, 0.0)};
  EXPECT_THROW(make_balance_record(record, 6), std::invalid_argument);
}

}  // namespace
}  // namespace slewlab::diagnosis
