#include "sim/analysis/spectrum.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>
#include <unsupported/Eigen/FFT>

namespace slewlab::sim {

namespace {

std::vector<double> without_trend(std::span<const double> series) {
  const auto n = static_cast<double>(series.size());
  double sum = 0.0, moment = 0.0;
  for (std::size_t i = 0; i < series.size(); ++i) {
    sum += series[i];
    moment += series[i] * (static_cast<double>(i) - 0.5 * (n - 1.0));
  }
  const double mean = series.empty() ? 0.0 : sum / n;
  const double spread = n * (n * n - 1.0) / 12.0;
  const double slope = spread > 0.0 ? moment / spread : 0.0;
  std::vector<double> result(series.begin(), series.end());
  for (std::size_t i = 0; i < result.size(); ++i) {
    result[i] -= mean + slope * (static_cast<double>(i) - 0.5 * (n - 1.0));
  }
  return result;
}

double hann(std::size_t i, std::size_t count) {
  return 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count));
}

std::vector<std::complex<double>> transform(std::vector<double>& values) {
  Eigen::FFT<double> fft;
  std::vector<std::complex<double>> result;
  fft.fwd(result, values);
  return result;
}

std::size_t power_of_two_above(std::size_t count) {
  std::size_t size = 1;
  while (size < count) size *= 2;
  return size;
}

}  // namespace

Spectrum amplitude_spectrum(std::span<const double> series, double step) {
  std::vector<double> values = without_trend(series);
  double window_sum = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double weight = hann(i, values.size());
    values[i] *= weight;
    window_sum += weight;
  }
  values.resize(power_of_two_above(4 * values.size()), 0.0);
  const auto lines = transform(values);
  Spectrum spectrum;
  spectrum.resolution = 1.0 / (step * static_cast<double>(values.size()));
  for (std::size_t k = 0; k < values.size() / 2; ++k) {
    spectrum.amplitude.push_back((k == 0 ? 1.0 : 2.0) * std::abs(lines[k]) / window_sum);
  }
  return spectrum;
}

std::vector<Peak> find_peaks(const Spectrum& spectrum, double lowest, double highest, double share) {
  std::vector<Peak> peaks;
  const auto& a = spectrum.amplitude;
  for (std::size_t k = 1; k + 1 < a.size(); ++k) {
    const double frequency = spectrum.resolution * static_cast<double>(k);
    if (frequency < lowest || frequency > highest) continue;
    if (!(a[k] > a[k - 1] && a[k] >= a[k + 1] && a[k - 1] > 0.0 && a[k + 1] > 0.0)) continue;
    const double left = std::log(a[k - 1]), middle = std::log(a[k]), right = std::log(a[k + 1]);
    const double curvature = left - 2.0 * middle + right;
    const double offset = curvature < 0.0 ? 0.5 * (left - right) / curvature : 0.0;
    peaks.push_back({.frequency = frequency + offset * spectrum.resolution,
                     .amplitude = std::exp(middle - 0.25 * (left - right) * offset)});
  }
  std::sort(peaks.begin(), peaks.end(), [](const Peak& x, const Peak& y) { return x.amplitude > y.amplitude; });
  if (!peaks.empty()) {
    const double limit = share * peaks.front().amplitude;
    std::erase_if(peaks, [&](const Peak& peak) { return peak.amplitude < limit; });
  }
  return peaks;
}

Peak largest_peak(const Spectrum& spectrum, double lowest, double highest) {
  const std::vector<Peak> peaks = find_peaks(spectrum, lowest, highest, 1.0);
  return peaks.empty() ? Peak{} : peaks.front();
}

double band_rms(std::span<const double> series, double step, double lowest, double highest) {
  std::vector<double> values = without_trend(series);
  const auto lines = transform(values);
  const auto count = static_cast<double>(values.size());
  double sum = 0.0;
  for (std::size_t k = 1; k <= values.size() / 2; ++k) {
    const double frequency = static_cast<double>(k) / (step * count);
    const double sides = 2 * k == values.size() ? 1.0 : 2.0;
    if (frequency >= lowest && frequency <= highest) sum += sides * std::norm(lines[k]);
  }
  return std::sqrt(sum) / count;
}

std::vector<double> power_spectral_density(std::span<const double> series, double step, int segment) {
  const auto length = static_cast<std::size_t>(std::max(segment, 0));
  if (length < 2 || series.size() < length) {
    throw std::invalid_argument("a spectral density needs a series of at least one segment of 2 samples");
  }
  std::vector<double> density(length / 2 + 1, 0.0);
  int segments = 0;
  for (std::size_t from = 0; from + length <= series.size(); from += std::max<std::size_t>(1, length / 2)) {
    std::vector<double> values = without_trend(series.subspan(from, length));
    double square_sum = 0.0;
    for (std::size_t i = 0; i < length; ++i) {
      const double weight = hann(i, length);
      values[i] *= weight;
      square_sum += weight * weight;
    }
    const auto lines = transform(values);
    for (std::size_t k = 0; k < density.size(); ++k) {
      const double sides = k == 0 || 2 * k == length ? 1.0 : 2.0;
      density[k] += sides * std::norm(lines[k]) * step / square_sum;
    }
    ++segments;
  }
  for (double& value : density) value /= segments;
  return density;
}

RingDown ring_down(std::span<const double> series, double step) {
  std::vector<double> crossings;  // [s]
  std::vector<double> peaks;      // largest size between two crossings
  double size = 0.0;
  for (std::size_t i = 1; i < series.size(); ++i) {
    const double left = series[i - 1], right = series[i];
    size = std::max(size, std::fabs(left));
    if ((left < 0.0) == (right < 0.0)) continue;
    if (!crossings.empty()) peaks.push_back(size);
    crossings.push_back(step * (static_cast<double>(i - 1) + left / (left - right)));
    size = 0.0;
  }
  RingDown result;
  if (crossings.size() < 4) return result;
  result.frequency = 0.5 * static_cast<double>(crossings.size() - 1) / (crossings.back() - crossings.front());
  const auto n = static_cast<double>(peaks.size());
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  for (std::size_t i = 0; i < peaks.size(); ++i) {
    const auto at = static_cast<double>(i);
    const double logarithm = std::log(peaks[i]);
    x += at;
    y += logarithm;
    xx += at * at;
    xy += at * logarithm;
  }
  // Half a period apart: slope = -pi zeta / sqrt(1 - zeta^2).
  const double decrement = -(n * xy - x * y) / (n * xx - x * x) / std::numbers::pi;
  result.damping_ratio = decrement / std::sqrt(1.0 + decrement * decrement);
  return result;
}

}  // namespace slewlab::sim
