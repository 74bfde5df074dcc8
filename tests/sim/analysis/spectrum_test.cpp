#include "sim/analysis/spectrum.h"
#include "tests/sim/angles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <stdexcept>

namespace slewlab::sim {
namespace {

template <typename Function>
std::vector<double> sampled(double step, int count, Function value) {
  std::vector<double> series;
  for (int i = 0; i < count; ++i) series.push_back(value(step * i));
  return series;
}

TEST(Spectrum, PeaksOfTwoSinesBesideMeanAndTrend) {
  const auto series = sampled(0.005, 2000, [](double t) {
    return 7.0 + 0.3 * t + 2.0 * std::sin(kTwoPi * 1.31 * t) + 0.5 * std::cos(kTwoPi * 5.24 * t);
  });
  const Spectrum spectrum = amplitude_spectrum(series, 0.005);
  const std::vector<Peak> peaks = find_peaks(spectrum, 0.5, 20.0, 0.1);
  ASSERT_EQ(peaks.size(), 2u);
  EXPECT_NEAR(peaks[0].frequency, 1.31, 0.005);
  EXPECT_NEAR(peaks[0].amplitude, 2.0, 0.05);
  EXPECT_NEAR(peaks[1].frequency, 5.24, 0.005);
  EXPECT_NEAR(peaks[1].amplitude, 0.5, 0.02);
  EXPECT_NEAR(largest_peak(spectrum, 3.0, 20.0).frequency, 5.24, 0.005);
  EXPECT_EQ(largest_peak(spectrum, 1000.0, 2000.0).frequency, 0.0);  // beyond the spectrum
}

TEST(Spectrum, BandHoldsTheRootMeanSquareOfItsSine) {
  const auto series = sampled(0.001, 10000, [](double t) {
    return 3.0 * std::sin(kTwoPi * 2.0 * t) + 0.2 * std::sin(kTwoPi * 8.0 * t);
  });
  EXPECT_NEAR(band_rms(series, 0.001, 1.0, 3.0), 3.0 / std::sqrt(2.0), 0.01);
  EXPECT_NEAR(band_rms(series, 0.001, 7.0, 9.0), 0.2 / std::sqrt(2.0), 0.005);
  EXPECT_LT(band_rms(series, 0.001, 20.0, 50.0), 0.01);
}

// Parseval: the density of white noise integrates to its variance and is flat at 2 variance step.
TEST(Spectrum, DensityOfWhiteNoise) {
  std::uint64_t seed = 1;
  const auto series = sampled(0.01, 40000, [&](double) {
    seed = seed * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(seed >> 11) / 9007199254740992.0 - 0.5;  // uniform, variance 1/12
  });
  const std::vector<double> density = power_spectral_density(series, 0.01, 500);
  double sum = 0.0;
  for (const double value : density) sum += value / (500 * 0.01);
  EXPECT_NEAR(sum, 1.0 / 12.0, 0.002);
  double low = 0.0;
  for (std::size_t k = 10; k < 60; ++k) low += density[k] / 50.0;
  EXPECT_NEAR(low, 2.0 / 12.0 * 0.01, 0.0002);
  EXPECT_THROW(power_spectral_density(series, 0.01, 50000), std::invalid_argument);
}

TEST(Spectrum, RingDownOfADampedOscillator) {
  const double natural = kTwoPi * 5.2, ratio = 0.02;
  const double damped = natural * std::sqrt(1.0 - ratio * ratio);
  const auto series = sampled(0.001, 3000, [&](double t) { return std::exp(-ratio * natural * t) * std::cos(damped * t); });
  const RingDown ring = ring_down(series, 0.001);
  EXPECT_NEAR(ring.frequency, damped / kTwoPi, 1e-3);
  EXPECT_NEAR(ring.damping_ratio, ratio, 2e-4);
  EXPECT_EQ(ring_down(std::vector<double>(100, 1.0), 0.001).frequency, 0.0);  // no crossing, no answer
}

}  // namespace
}  // namespace slewlab::sim
