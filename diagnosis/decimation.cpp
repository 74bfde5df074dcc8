#include "diagnosis/decimation.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <numbers>

namespace slewlab::diagnosis {
namespace {

constexpr double kCutoff = 0.8;       // of the new Nyquist frequency
constexpr std::int64_t kReach = 8;    // [new samples] to either side
constexpr std::int64_t kHeldReach = 24;  // the same where the response is not even: the window smooths what bends

double blackman(double share) { return 0.42 + 0.5 * std::cos(std::numbers::pi * share) + 0.08 * std::cos(2.0 * std::numbers::pi * share); }

// Weights for the distances 0 ... kReach stride; Blackman's window ends at zero.
std::vector<double> weights(std::size_t stride) {
  const double reach = static_cast<double>(kReach) * static_cast<double>(stride);
  std::vector<double> weight;
  for (int n = 0; n < reach; ++n) {
    const double distance = n;
    const double phase = std::numbers::pi * kCutoff * distance / static_cast<double>(stride);
    weight.push_back(blackman(distance / reach) * (distance == 0.0 ? 1.0 : std::sin(phase) / phase));
  }
  return weight;
}

double sinc(double x) { return x == 0.0 ? 1.0 : std::sin(std::numbers::pi * x) / (std::numbers::pi * x); }

// Weights of held values whose middles lie `first`, `first` + 1 ... values from that of the new one, within kHeldReach of them: of the response that an inertia asks for up to the cut-off.
std::vector<double> held_weights(double first, std::size_t stride) {
  constexpr int kParts = 256;  // of the band, for the integral over it
  const auto steps = static_cast<double>(stride);
  const double reach = static_cast<double>(kHeldReach) * steps, cutoff = 0.5 * kCutoff / steps;  // [values], [swings per value]
  std::vector<double> weight;
  for (int n = 0; first + n < reach; ++n) {
    const double distance = first + n;
    double sum = 0.0;
    for (int part = 0; part < kParts; ++part) {
      const double f = cutoff * (part + 0.5) / kParts;
      const double held_long = sinc(f * steps);
      sum += sinc(f) * held_long * held_long / std::cos(std::numbers::pi * f * steps) * std::cos(2.0 * std::numbers::pi * f * distance);
    }
    weight.push_back(blackman(distance / reach) * sum);
  }
  return weight;
}

}  // namespace

std::vector<double> held_decimated(const std::vector<double>& held, std::size_t stride) {
  if (stride <= 1) return held;
  const bool is_odd = stride % 2 == 1;
  const std::vector<double> weight = held_weights(is_odd ? 0.0 : 0.5, stride);
  const auto count = static_cast<std::int64_t>(held.size()), half = static_cast<std::int64_t>(stride / 2);
  std::vector<double> result;
  for (std::int64_t from = 0; from < count; from += static_cast<std::int64_t>(stride)) {
    const std::int64_t above = std::min(count - 1, from + half), below = is_odd ? above : above - 1;  // beside the middle, or both on it
    double sum = 0.0, norm = 0.0;
    for (std::int64_t k = 0; k < static_cast<std::int64_t>(weight.size()) && below - k >= 0 && above + k < count; ++k) {
      const double w = is_odd && k == 0 ? 0.5 * weight[0] : weight[static_cast<std::size_t>(k)];
      sum += w * (held[static_cast<std::size_t>(below - k)] + held[static_cast<std::size_t>(above + k)]);
      norm += 2.0 * w;
    }
    result.push_back(sum / norm);
  }
  return result;
}

std::vector<double> means(const std::vector<double>& held, std::size_t stride) {
  std::vector<double> taken;
  for (std::size_t n = 0; n < held.size(); n += stride) {
    const std::size_t count = std::min(stride, held.size() - n);
    double more = 0.0;  // than the first one
    for (std::size_t k = 1; k < count; ++k) more += held[n + k] - held[n];
    taken.push_back(held[n] + more / static_cast<double>(count));
  }
  return taken;
}

std::vector<double> decimated(const std::vector<double>& series, std::size_t stride) {
  if (stride <= 1) return series;
  const std::vector<double> weight = weights(stride);
  const auto reach = static_cast<std::int64_t>(weight.size()) - 1;
  const auto count = static_cast<std::int64_t>(series.size());
  std::vector<double> result;
  for (std::int64_t n = 0; n < count; n += static_cast<std::int64_t>(stride)) {
    if (!std::isfinite(series[static_cast<std::size_t>(n)])) {
      result.push_back(std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    double sum = 0.0, norm = 0.0;
    const std::int64_t both = std::min({reach, n, count - 1 - n});  // what is longer on one side would shift what rises
    for (std::int64_t k = n - both; k <= n + both; ++k) {
      const double value = series[static_cast<std::size_t>(k)];
      if (!std::isfinite(value)) continue;
      const double w = weight[static_cast<std::size_t>(std::abs(k - n))];
      sum += w * value;
      norm += w;
    }
    result.push_back(sum / norm);
  }
  return result;
}

}  // namespace slewlab::diagnosis
