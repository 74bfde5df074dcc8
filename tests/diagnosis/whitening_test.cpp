#include "diagnosis/whitening.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <unsupported/Eigen/FFT>

namespace slewlab::diagnosis {
namespace {

constexpr std::size_t kCount = 30000;  // 30 s at 1 kHz

// Of noise that is white: no corner.
const WhiteningSettings kSettings{.highest_frequency = 40.0, .lowest_frequency = 0.02, .noise_corner = 0.0, .encoder_noise_from = 20.0, .soft_edge = 0.4,
                                  .least_torque = 1e-6, .least_acceleration = 1e-6};

constexpr double kLeastBeside = 0.01;  // of a channel's variance, that no other one tells

std::vector<double> white(double deviation, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal(0.0, deviation);
  std::vector<double> values(kCount);
  for (double& value : values) value = normal(generator);
  return values;
}

// One group whose encoder stands, one accelerometer with noise alone, of 0.01 m/s^2 at 1 kHz unless it is given.
Record noisy_record(std::vector<double> noise = white(0.01, 1), double step = 1e-3) {
  Record record;
  record.step = record.encoder_period = step;
  record.group_count = 1;
  for (auto* series : {&record.motor_torque[0], &record.shaft_speed[0], &record.position_rate[0], &record.shaft_position[0]}) series->assign(noise.size(), 0.0);
  record.acceleration[kTip] = std::move(noise);
  return record;
}

Shadow shadow_of(std::vector<double> tip_difference) {
  Shadow shadow;
  shadow.missing_torque[0].assign(tip_difference.size(), 0.0);
  shadow.contact_lost.assign(tip_difference.size(), false);
  shadow.acceleration_difference[kTip] = std::move(tip_difference);
  return shadow;
}

// Of an observer that neither the encoder nor the tip leads: what they read off is what it differs by.
NoiseResponse as_read(std::size_t count = kCount) {
  const std::vector<std::complex<double>> one(transform_length(count) / 2 + 1, 1.0), none(one.size(), 0.0);
  NoiseResponse response;
  response.encoder[0].torque[0] = response.tip.acceleration[kTip] = one;
  response.encoder[0].acceleration[kTip] = response.tip.torque[0] = none;
  return response;
}

double mean_square(const Whitening& whitening, const Shadow& shadow, std::size_t channel) {
  const Eigen::VectorXd all = whiten(whitening, shadow);
  const auto rows = static_cast<Eigen::Index>(2 * whitening.bin_count);
  return all.segment(static_cast<Eigen::Index>(channel) * rows, rows).squaredNorm() / static_cast<double>(rows);
}

// The definition of the weights: the whitened residual of noise alone has variance 1. It is about 2400 numbers, so within 5 sigma of it.
TEST(Whitening, NoiseAloneHasVarianceOne) {
  const Record record = noisy_record();
  const WhiteningSettings settings = kSettings;
  const Whitening whitening =
      make_whitening(record, std::vector<bool>(kCount, true), as_read(), shadow_of(record.acceleration[kTip]), settings);
  ASSERT_EQ(whitening.channels.size(), 2U);
  EXPECT_NEAR(mean_square(whitening, shadow_of(white(0.01, 2)), 1), 1.0, 0.15);
  EXPECT_NEAR(mean_square(whitening, shadow_of(white(0.02, 3)), 1), 4.0, 0.6);
}

// White noise of deviation 1 and noise that rises as 1/f, as strong as that at the corner: filters of first order, one per octave, as Corsini and
// Saletti have it (IEEE Transactions on Instrumentation and Measurement 37, 1988). A filter of corner f_i and variance v has the one-sided
// density (2 v / pi) f_i / (f^2 + f_i^2), and over octaves they add up to v / (f ln 2); white noise has 2 step.
std::vector<double> flickering(double corner, double step, std::size_t count, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  std::vector<double> values(count);
  for (double& value : values) value = normal(generator);
  const double deviation = std::sqrt(2.0 * step * corner * std::numbers::ln2);
  double frequency = 0.25 / step;
  while (frequency > 1e-3) {
    const double keep = std::exp(-2.0 * std::numbers::pi * frequency * step);
    double state = deviation * normal(generator);
    for (double& value : values) {
      state = keep * state + deviation * std::sqrt(1.0 - keep * keep) * normal(generator);
      value += state;
    }
    frequency *= 0.5;
  }
  return values;
}

// The definition of the weights again, of an accelerometer that is read at 100 Hz: its data sheet says 50 Hz, its noise is white from lower on, and what
// its fastest differences show is not white noise alone. Bands hold some 600 numbers at least, over eight records: within 20 %, more than 5 sigma, and what
// the filters' sum is off.
TEST(Whitening, TellsHowTheNoiseOfAnAccelerometerRises) {
  constexpr double kStep = 0.01;        // [s]
  constexpr std::size_t kPoints = 4000;
  for (const double corner : {0.5, 5.0, 15.0}) {
    std::array<double, 3> square{}, numbers{};
    for (unsigned seed = 1; seed <= 8; ++seed) {
      const Record record = noisy_record(flickering(corner, kStep, kPoints, seed), kStep);
      const Shadow shadow = shadow_of(record.acceleration[kTip]);
      WhiteningSettings settings = kSettings;
      settings.noise_corner = 50.0;
      settings.corner_from = 2.0;
      settings.discrepancy_share = 0.0;
      const Whitening whitening = make_whitening(record, std::vector<bool>(kPoints, true), as_read(kPoints), shadow, settings);
      const Eigen::VectorXd all = whiten(whitening, shadow).tail(static_cast<Eigen::Index>(2 * whitening.bin_count));
      for (std::size_t b = 0; b < whitening.bin_count; ++b) {
        const double frequency = static_cast<double>(whitening.first_bin + b) * whitening.bin_width;
        const std::size_t band = frequency < 3.0 ? 0 : frequency < 10.0 ? 1 : 2;
        square[band] += all.segment(static_cast<Eigen::Index>(2 * b), 2).squaredNorm();
        numbers[band] += 2.0;
      }
    }
    for (std::size_t band = 0; band < 3; ++band) EXPECT_NEAR(square[band] / numbers[band], 1.0, 0.2) << "corner " << corner << " Hz, band " << band;
  }
}

// A machine that moves as its torques were before they were written down in steps of 0.1 Nm; it answers to a torque with just that.
double of_rounded_torque(const std::vector<double>& torque, bool is_slow) {
  constexpr double kQuantum = 0.1;  // [Nm]
  Record record = noisy_record();
  record.torque_rounding = {kQuantum, is_slow};
  record.torque_noise = variance_of(record.torque_rounding);
  Shadow shadow = shadow_of(record.acceleration[kTip]);
  for (std::size_t n = 0; n < kCount; ++n) {
    record.motor_torque[0][n] = kQuantum * std::round(torque[n] / kQuantum);
    shadow.missing_torque[0][n] = record.motor_torque[0][n] - torque[n];
  }
  NoiseResponse response = as_read();
  response.torque[0] = response.encoder[0];
  WhiteningSettings settings = kSettings;
  settings.discrepancy_share = 0.0;
  settings.count_smoothing = 0.1;
  return mean_square(make_whitening(record, std::vector<bool>(kCount, true), response, shadow, settings), shadow, 0);
}

// What each source brings is told with what the nominal machine makes of it: here of the torque alone, of which every bin has q^2 / 12 of each point under the window.
TEST(Whitening, TellsTheNoiseOfRoundedTorquesWithItsSources) {
  constexpr double kQuantum = 0.1;  // [Nm]
  Record record = noisy_record();
  record.torque_noise = kQuantum * kQuantum / 12.0;
  NoiseResponse response = as_read();
  response.torque[0] = response.encoder[0];
  const Whitening whitening = make_whitening(record, std::vector<bool>(kCount, true), response, shadow_of(record.acceleration[kTip]), kSettings);
  double energy = 0.0;
  for (const double weight : whitening.window) energy += weight * weight;
  const double expected = kQuantum * kQuantum / 12.0 * energy;
  ASSERT_EQ(whitening.torque_power.size(), 1U);
  for (std::size_t b = 0; b < whitening.bin_count; ++b) {
    EXPECT_NEAR(whitening.torque_power[0][b], expected, 1e-9 * expected);
    const double weight = whitening.weight[0](static_cast<Eigen::Index>(b)), of_torque = 0.5 * weight * weight * expected;
    EXPECT_LE(whitening.beside[0](static_cast<Eigen::Index>(b)), std::max(kLeastBeside, 1.0 - of_torque * (1.0 - 1e-9)));
  }
}

// What is in two channels is in the first alone behind the whitening: each of variance 1 still, as NoiseAloneHasVarianceOne, and the mean product of the two none, both parts of the some
// 1200 numbers within 5 sigma. The encoder is read with noise, of which the tip holds twice as much, a quarter of a turn later; its sensor has noise of its own.
TEST(Whitening, FreesEachChannelOfWhatTheOnesBeforeItHold) {
  const std::vector<double> common = white(0.01, 6), own = white(0.01, 7);
  Record record = noisy_record();
  record.noise = SensorNoise{};
  record.noise->encoder[0] = 1e-4;
  record.noise->accelerometer[kTip] = 1e-4;
  NoiseResponse response = as_read();
  const std::complex<double> twice(0.0, 2.0);
  std::fill(response.encoder[0].acceleration[kTip].begin(), response.encoder[0].acceleration[kTip].end(), twice);
  // A quarter of a turn at every frequency: Hilbert's transform, by its spectrum.
  Eigen::FFT<double> fft;
  std::vector<std::complex<double>> spectrum;
  fft.fwd(spectrum, common);
  for (std::size_t k = 0; k < spectrum.size(); ++k) spectrum[k] *= k < spectrum.size() / 2 ? twice : std::conj(twice);
  std::vector<double> turned;
  fft.inv(turned, spectrum);
  for (std::size_t n = 0; n < kCount; ++n) turned[n] += own[n];
  record.acceleration[kTip] = own;
  Shadow shadow = shadow_of(turned);
  shadow.missing_torque[0] = common;
  WhiteningSettings settings = kSettings;
  settings.discrepancy_share = 0.0;
  const Whitening whitening = make_whitening(record, std::vector<bool>(kCount, true), response, shadow, settings);
  EXPECT_NEAR(mean_square(whitening, shadow, 0), 1.0, 0.15);
  EXPECT_NEAR(mean_square(whitening, shadow, 1), 1.0, 0.15);
  const Eigen::VectorXd all = whiten(whitening, shadow);
  const auto rows = static_cast<Eigen::Index>(2 * whitening.bin_count);
  std::complex<double> product = 0.0;
  for (Eigen::Index row = 0; row < rows; row += 2) product += std::complex(all(row), all(row + 1)) * std::conj(std::complex(all(rows + row), all(rows + row + 1)));
  EXPECT_LT(std::abs(product) / static_cast<double>(rows), 0.15);
  // The tip's variance is five times its sensor's, of whose root 2 / sqrt(5) goes with the encoder.
  const ChannelMatrix apart = apart_at(whitening, whitening.bin_count / 2);
  EXPECT_NEAR(std::abs(apart(1, 0) / apart(1, 1)), 2.0 / std::sqrt(5.0) / (1.0 + kLeastBeside), 1e-3);
}

// Torques that change by many steps at a time are off by anything between two of them: the definition of the weights once more, of about 2400 numbers.
TEST(Whitening, KnowsHowTorquesWereRounded) { EXPECT_NEAR(of_rounded_torque(white(5.0, 5), false), 1.0, 0.15); }

// Slow ones are off by the same for long, which is no white noise: such an error has sixty times the power of white noise at the frequencies of its own changes. How it falls
// among the places between two steps is one draw of them, so a factor of two.
TEST(Whitening, KnowsHowSlowTorquesWereRounded) {
  std::vector<double> slow;
  for (std::size_t n = 0; n < kCount; ++n) {
    const double t = 1e-3 * static_cast<double>(n);  // [s]
    slow.push_back(2.0 * std::sin(1.3 * t) + 0.5 * std::sin(3.7 * t));
  }
  const double left = of_rounded_torque(slow, true);
  EXPECT_GT(left, 0.5);
  EXPECT_LT(left, 2.0);
}

// Behind a moment in which no gear holds the house nothing is trusted of a record that begins in motion; of one that begins at rest what lies near impacts is not.
TEST(Whitening, TrustsNothingBehindALooseHouseWhereItsSwingIsNotKnown) {
  constexpr std::size_t kAt = 12000;
  constexpr double kAfterImpact = 2.0;  // [s]
  WhiteningSettings settings = kSettings;
  settings.after_impact = kAfterImpact;
  Record record = noisy_record();
  Shadow shadow = shadow_of(record.acceleration[kTip]);
  shadow.contact_lost[kAt] = true;
  shadow.house_let_go.assign(record.size(), false);
  shadow.house_let_go[kAt] = true;
  const std::vector<bool> at_rest = trusted_stretches(record, shadow, settings);
  record.begins_bent = true;
  const std::vector<bool> in_motion = trusted_stretches(record, shadow, settings);
  EXPECT_FALSE(at_rest[kAt]);
  EXPECT_TRUE(at_rest.back());
  EXPECT_TRUE(in_motion[kAt / 2]);
  EXPECT_EQ(std::count(in_motion.begin() + kAt, in_motion.end(), true), 0);
}

// What lies where the record is not trusted changes nothing.
TEST(Whitening, ForgetsWhatIsNotTrusted) {
  const Record record = noisy_record();
  std::vector<bool> trusted(kCount, true);
  std::fill(trusted.begin() + 10000, trusted.begin() + 15000, false);
  const Whitening whitening =
      make_whitening(record, trusted, as_read(), shadow_of(record.acceleration[kTip]), kSettings);
  std::vector<double> difference = white(0.01, 4);
  const Eigen::VectorXd before = whiten(whitening, shadow_of(difference));
  std::fill(difference.begin() + 10000, difference.begin() + 15000, 100.0);
  EXPECT_EQ((whiten(whitening, shadow_of(difference)) - before).norm(), 0.0);
}

// 4 ln of weight times the triangle's diagonal, of each of three bins: a channel of weight 2 that stands alone, and one of 1/2 that is stretched by 4 beside it.
TEST(Whitening, TellsByHowMuchItStretches) {
  Whitening whitening;
  whitening.channels = {{true, 0}, {false, 0}};
  whitening.bin_count = 3;
  whitening.weight = {Eigen::VectorXd::Constant(3, 2.0), Eigen::VectorXd::Constant(3, 0.5)};
  for (int bin = 0; bin < 3; ++bin) whitening.apart.insert(whitening.apart.end(), {{1.0, 0.0}, {0.3, -0.7}, {4.0, 0.0}});
  EXPECT_DOUBLE_EQ(log_stretch(whitening), 4.0 * 3.0 * (std::log(2.0) + std::log(0.5 * 4.0)));
}

}  // namespace
}  // namespace slewlab::diagnosis
