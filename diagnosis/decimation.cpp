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

// Weights for the distances 0 ... kReach stride; Blackman's window ends at zero.
std::vector<double> weights(std::size_t stride) {
  const double reach = static_cast<double>(kReach) * static_cast<double>(stride);
  std::vector<double> weight;
  for (double distance = 0.0; distance < reach; distance += 1.0) {
    const double phase = std::numbers::pi * kCutoff * distance / static_cast<double>(stride);
    const double window = 0.42 + 0.5 * std::cos(std::numbers::pi * distance / reach) +
                          0.08 * std::cos(2.0 * std::numbers::pi * distance / reach);
    weight.push_back(window * (distance == 0.0 ? 1.0 : std::sin(phase) / phase));
  }
  return weight;
}

}  // namespace

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
    for (std::int64_t k = std::max<std::int64_t>(0, n - reach); k <= std::min(count - 1, n + reach); ++k) {
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
