#include "sim/drive/latency_histogram.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace slewlab::sim {
namespace {

constexpr double kFirstEdge = 100.0;  // [ns] lower edge of the second bin; a call of the clock takes about 25 ns

}  // namespace

void LatencyHistogram::add(std::int64_t duration) {
  duration = std::max<std::int64_t>(duration, 0);
  int bin = 0;
  if (static_cast<double>(duration) > kFirstEdge) {
    bin = 1 + static_cast<int>(std::floor(kBinsPerOctave * std::log2(static_cast<double>(duration) / kFirstEdge)));
  }
  ++bins_[static_cast<std::size_t>(std::min<int>(bin, static_cast<int>(bins_.size()) - 1))];
  ++count_;
  largest_ = std::max(largest_, duration);
}

double LatencyHistogram::percentile(double share) const {
  const double wanted = share * static_cast<double>(count_);
  double seen = 0.0;
  for (std::size_t bin = 0; bin < bins_.size(); ++bin) {
    seen += static_cast<double>(bins_[bin]);
    if (seen >= wanted && seen > 0.0) {
      const double edge = kFirstEdge * std::exp2(static_cast<double>(bin) / kBinsPerOctave);
      return std::min(edge, static_cast<double>(largest_));
    }
  }
  return static_cast<double>(largest_);
}

double LatencyHistogram::octave_edge(int octave) {
  return octave + 1 == kOctaves ? std::numeric_limits<double>::infinity()
                                : kFirstEdge * std::exp2(octave + 1.0 - 1.0 / kBinsPerOctave);
}

std::int64_t LatencyHistogram::octave_count(int octave) const {
  std::int64_t sum = 0;
  const int first = octave * kBinsPerOctave;
  for (int bin = first; bin < first + kBinsPerOctave; ++bin) sum += bins_[static_cast<std::size_t>(bin)];
  return sum;
}

}  // namespace slewlab::sim
