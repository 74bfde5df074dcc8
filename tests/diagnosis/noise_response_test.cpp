#include "diagnosis/noise_response.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <string>
#include <unsupported/Eigen/FFT>

#include "tests/diagnosis/bench.h"

namespace slewlab::diagnosis {
namespace {

// The bench's machine standing, with the tip's accelerometer; its gears have no play, so that it follows noise as a linear machine does.
struct Noisy {
  sim::MachineSettings machine;
  Record record;
  ShadowGains gains;
};
Noisy standing(double period) {
  Noisy noisy;
  noisy.machine.crane = bench().crane;
  noisy.machine.crane.drive.gearbox_play = noisy.machine.crane.drive.pinion_play = 0.0;
  Record& record = noisy.record;
  constexpr double kLong = 120.0;  // [s]
  const auto count = static_cast<std::size_t>(kLong / period);
  record.step = record.encoder_period = period;
  record.group_count = 2;
  for (std::size_t g = 0; g < 2; ++g) {
    for (auto* series : {&record.motor_torque[g], &record.shaft_speed[g], &record.shaft_position[g], &record.position_rate[g]}) series->assign(count, 0.0);
  }
  record.acceleration[kTip].assign(count, 0.0);
  noisy.gains = shadow_gains(bench().machine.scales, not_faster_than(bench().thresholds.shadow, period));
  return noisy;
}

DriveCourse idle(std::size_t count) {
  DriveCourse drives;
  for (std::size_t g = 0; g < 2; ++g) {
    drives.motor_torque[g].assign(count, 0.0);
    drives.brake_torque[g].assign(count, 0.0);
  }
  drives.enable.assign(count, true);
  return drives;
}

using Spectrum = std::vector<std::complex<double>>;

// Under Hann's window of energy 1, in a transform of so many points.
Spectrum windowed_spectrum(const std::vector<double>& channel, std::size_t length) {
  std::vector<double> windowed(length, 0.0);
  double energy = 0.0;
  for (std::size_t n = 0; n < channel.size(); ++n) {
    const double weight = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * (static_cast<double>(n) + 0.5) / static_cast<double>(channel.size()));
    windowed[n] = weight * channel[n];
    energy += weight * weight;
  }
  Spectrum spectrum;
  Eigen::FFT<double>().fwd(spectrum, windowed);
  for (std::complex<double>& value : spectrum) value /= std::sqrt(energy);
  return spectrum;
}

// Mean over the bins of a band of what two channels have in common, in what their responses say of noise of variance 1: 1, and of one channel with itself its power. Each is exponential.
std::complex<double> whitened_product(const std::vector<double>& a, const Spectrum& response_a, const std::vector<double>& b, const Spectrum& response_b, double step, double from,
                                      double to) {
  const std::size_t length = 2 * (response_a.size() - 1);
  const Spectrum of_a = windowed_spectrum(a, length), of_b = windowed_spectrum(b, length);
  const double bin = 1.0 / (step * static_cast<double>(length));
  std::complex<double> sum = 0.0;
  std::size_t bins = 0;
  for (auto k = static_cast<std::size_t>(from / bin); static_cast<double>(k) * bin < to; ++k, ++bins) {
    sum += of_a[k] * std::conj(of_b[k]) / (response_a[k] * std::conj(response_b[k]));
  }
  return sum / static_cast<double>(bins);
}

// Of some hundred bins at least, of which Hann's window makes two thirds independent: within four deviations, and 5 % for what it
// leaks where a response falls steeply.
void expect_in_common(const std::vector<double>& a, const Spectrum& response_a, const std::vector<double>& b, const Spectrum& response_b, double step, const std::string& what) {
  const std::vector<double> edges{0.5, 3.0, 10.0, std::min(40.0, 0.4 / step)};  // [Hz]
  for (std::size_t k = 0; k + 1 < edges.size(); ++k) {
    const double bins = (edges[k + 1] - edges[k]) * step * static_cast<double>(a.size());
    EXPECT_LT(std::abs(whitened_product(a, response_a, b, response_b, step, edges[k], edges[k + 1]) - 1.0), 0.05 + 4.0 / std::sqrt(bins / 1.5))
        << what << ", from " << edges[k] << " Hz";
  }
}
void expect_white(const std::vector<double>& channel, const Spectrum& response, double step, const std::string& what) {
  expect_in_common(channel, response, channel, response, step, what);
}

class NoiseResponseAt : public ::testing::TestWithParam<double> {};

// The judge: the observer itself, led by drawn noise.
TEST_P(NoiseResponseAt, SaysWhatWhiteNoiseOfASensorMakesOfEveryChannel) {
  Noisy noisy = standing(GetParam());
  noisy.record.torque_noise = 1.0;
  const std::size_t count = noisy.record.size(), length = transform_length(count);
  const NoiseResponse response = noise_response(noisy.machine, noisy.record, noisy.gains, length);
  std::mt19937 generator(5);
  std::normal_distribution<double> normal;
  DriveCourse drives = idle(count);
  const auto follow = [&] {
    Shadow result;
    std::vector<Shadowing> alone;
    alone.push_back({follower_of(noisy.machine, grid_of(noisy.record)), 0.0, {}, &result});
    shadow(std::move(alone), noisy.record, drives, noisy.gains);
    return result;
  };
  std::vector<double>& position = noisy.record.shaft_position[0];
  for (double& value : position) value = normal(generator);
  position[0] = 0.0;  // where the motor stands
  const Shadow of_encoder = follow();
  const double step = noisy.record.step;
  for (std::size_t g = 0; g < 2; ++g) {
    expect_white(of_encoder.missing_torque[g], response.encoder[0].torque[g], step, "encoder to motor " + std::to_string(g + 1));
  }
  expect_white(of_encoder.acceleration_difference[kTip], response.encoder[0].acceleration[kTip], step, "encoder to tip");
  expect_in_common(of_encoder.missing_torque[0], response.encoder[0].torque[0], of_encoder.acceleration_difference[kTip], response.encoder[0].acceleration[kTip], step,
                   "encoder to motor 1 and tip");
  std::fill(position.begin(), position.end(), 0.0);
  for (double& value : noisy.record.acceleration[kTip]) value = normal(generator);
  const Shadow of_tip = follow();
  expect_white(of_tip.acceleration_difference[kTip], response.tip.acceleration[kTip], step, "tip to tip");
  expect_white(of_tip.missing_torque[1], response.tip.torque[1], step, "tip to motor 2");
  std::fill(noisy.record.acceleration[kTip].begin(), noisy.record.acceleration[kTip].end(), 0.0);
  for (double& value : drives.motor_torque[0]) value = normal(generator);
  const Shadow of_torque = follow();
  expect_white(of_torque.missing_torque[0], response.torque[0].torque[0], step, "torque to motor 1");
  expect_white(of_torque.acceleration_difference[kTip], response.torque[0].acceleration[kTip], step, "torque to tip");
}

INSTANTIATE_TEST_SUITE_P(Rates, NoiseResponseAt, ::testing::Values(1e-3, 5e-3, 1e-2));

}  // namespace
}  // namespace slewlab::diagnosis
