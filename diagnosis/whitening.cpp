#include "diagnosis/whitening.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>

namespace slewlab::diagnosis {

namespace {

constexpr double kBeforeImpact = 0.3;  // [s] a real crane may let go a little before its model
constexpr double kAfterImpact = 1.5;   // [s] in which the shadow forgets an impact, two of its time constants
constexpr double kSoftEdge = 0.4;      // [s] over which the window falls beside a stretch that is taken out
constexpr double kTaper = 0.02;  // share of the record over which the window rises and falls

// The next length that 2, 3 and 5 divide down to 1: where the transform is fast.
std::size_t fast_length(std::size_t count) {
  for (;; ++count) {
    std::size_t rest = count;
    for (const std::size_t factor : {2U, 3U, 5U}) {
      while (rest % factor == 0) rest /= factor;
    }
    if (rest == 1 && count % 2 == 0) return count;
  }
}

std::vector<std::complex<double>> transform(const std::vector<double>& values, const std::vector<double>& window,
                                            std::size_t length) {
  std::vector<double> padded(length, 0.0);
  for (std::size_t n = 0; n < values.size(); ++n) padded[n] = values[n] * window[n];
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  std::vector<std::complex<double>> spectrum;
  fft.fwd(spectrum, padded);
  return spectrum;
}

// Noise power per bin of a white sensor noise, from the median size of second differences: motion is smooth
// over 1 ms, noise is not. For white noise the second difference has 6 times its variance.
double noise_power(const std::vector<double>& values, const std::vector<double>& window) {
  std::vector<double> differences;
  for (std::size_t n = 2; n < values.size(); ++n) {
    differences.push_back(std::fabs(values[n] - 2.0 * values[n - 1] + values[n - 2]));
  }
  if (differences.empty()) return 0.0;
  std::nth_element(differences.begin(), differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2),
                   differences.end());
  const double deviation = differences[differences.size() / 2] / 0.6745 / std::sqrt(6.0);
  double energy = 0.0;
  for (const double w : window) energy += w * w;
  return deviation * deviation * energy;
}

const std::vector<double>& measured(const Record& record, const Channel& channel) {
  const auto i = static_cast<std::size_t>(channel.index);
  return channel.is_torque ? record.motor_torque[i] : record.acceleration[i];
}

}  // namespace

std::vector<bool> trusted_stretches(const Record& record, const Shadow& shadow) {
  const std::size_t count = record.size();
  std::vector<bool> trusted(count, true);
  const auto before = static_cast<std::size_t>(kBeforeImpact / record.step);
  const auto after = static_cast<std::size_t>(kAfterImpact / record.step);
  for (std::size_t n = 0; n < count; ++n) {
    if (!shadow.contact_lost[n]) continue;
    const std::size_t from = n > before ? n - before : 0;
    const std::size_t to = std::min(count, n + after);
    std::fill(trusted.begin() + static_cast<std::ptrdiff_t>(from), trusted.begin() + static_cast<std::ptrdiff_t>(to), false);
  }
  return trusted;
}

Whitening make_whitening(const Record& record, const std::vector<bool>& trusted, double motor_inertia,
                         const WhiteningSettings& settings) {
  Whitening whitening;
  const std::size_t count = record.size();
  whitening.transform_length = fast_length(count);
  whitening.bin_width = 1.0 / (record.step * static_cast<double>(whitening.transform_length));
  whitening.first_bin =
      std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(settings.lowest_frequency / whitening.bin_width)));
  const double highest = std::min(settings.highest_frequency, 0.4 / record.encoder_period);
  whitening.bin_count = static_cast<std::size_t>(highest / whitening.bin_width) - whitening.first_bin;
  whitening.window.assign(count, 1.0);
  const auto edge = static_cast<std::size_t>(kTaper * static_cast<double>(count));
  for (std::size_t n = 0; n < edge; ++n) {
    const double rise = 0.5 - 0.5 * std::cos(3.14159265358979 * (static_cast<double>(n) + 0.5) / static_cast<double>(edge));
    whitening.window[n] = rise;
    whitening.window[count - 1 - n] = rise;
  }
  for (std::size_t n = 0; n < count; ++n) {
    if (!trusted[n]) whitening.window[n] = 0.0;
  }
  // Edges of what was taken out, softened by a running mean, so that they leak little into other frequencies.
  const auto soft = static_cast<std::size_t>(kSoftEdge / record.step);
  std::vector<double> mean(count, 0.0);
  double running = 0.0;
  for (std::size_t n = 0; n < count; ++n) {
    running += whitening.window[n];
    if (n >= soft) running -= whitening.window[n - soft];
    mean[n] = running / static_cast<double>(soft);
  }
  for (std::size_t n = 0; n < count; ++n) {
    const double centred = mean[std::min(count - 1, n + soft / 2)];
    whitening.window[n] = trusted[n] ? std::min(whitening.window[n], std::max(0.0, 2.0 * centred - 1.0)) : 0.0;
  }
  for (int g = 0; g < record.group_count; ++g) whitening.channels.push_back({true, g});
  for (int a = 0; a < kAccelerometerCount; ++a) {
    if (!record.acceleration[static_cast<std::size_t>(a)].empty()) whitening.channels.push_back({false, a});
  }
  for (const Channel& channel : whitening.channels) {
    const std::vector<double>& signal = measured(record, channel);
    const auto spectrum = transform(signal, whitening.window, whitening.transform_length);
    // Running sums of the power give its mean over any band at once.
    std::vector<double> sum(spectrum.size() + 1, 0.0);
    for (std::size_t k = 0; k < spectrum.size(); ++k) sum[k + 1] = sum[k] + std::norm(spectrum[k]);
    // The torque channel's noise is the encoder's, seen through the shadow's speed gain.
    const double gain = channel.is_torque ? ShadowSettings{}.speed_rate * motor_inertia : 1.0;
    const std::vector<double>& noisy =
        channel.is_torque ? record.shaft_speed[static_cast<std::size_t>(channel.index)] : signal;
    const double noise = gain * gain * noise_power(noisy, whitening.window) +
                         1e-9 * sum.back() / static_cast<double>(spectrum.size());
    Eigen::VectorXd weight(static_cast<Eigen::Index>(whitening.bin_count));
    for (std::size_t b = 0; b < whitening.bin_count; ++b) {
      const std::size_t k = whitening.first_bin + b;
      const std::size_t half = 4 + static_cast<std::size_t>(0.5 * settings.smoothing * static_cast<double>(k));
      const std::size_t low = k > half ? k - half : 1;
      const std::size_t high = std::min(k + half + 1, spectrum.size());
      const double power = (sum[high] - sum[low]) / static_cast<double>(high - low);
      const double share = settings.discrepancy_share;
      const double frequency = static_cast<double>(k) * whitening.bin_width;
      const double coloured = channel.is_torque ? 1.0 : 1.0 + settings.noise_corner / frequency;
      weight(static_cast<Eigen::Index>(b)) = 1.0 / std::sqrt(share * share * power + noise * coloured);
    }
    whitening.weight.push_back(weight);
  }
  return whitening;
}

Eigen::VectorXd whiten(const Whitening& whitening, const Shadow& shadow) {
  Eigen::VectorXd result(whitening.size());
  Eigen::Index row = 0;
  for (std::size_t c = 0; c < whitening.channels.size(); ++c) {
    const Channel& channel = whitening.channels[c];
    const auto i = static_cast<std::size_t>(channel.index);
    const std::vector<double>& values =
        channel.is_torque ? shadow.missing_torque[i] : shadow.acceleration_difference[i];
    const auto spectrum = transform(values, whitening.window, whitening.transform_length);
    for (std::size_t b = 0; b < whitening.bin_count; ++b) {
      const std::complex<double> value = spectrum[whitening.first_bin + b];
      const double weight = whitening.weight[c](static_cast<Eigen::Index>(b));
      result(row++) = weight * value.real();
      result(row++) = weight * value.imag();
    }
  }
  return result;
}

}  // namespace slewlab::diagnosis
