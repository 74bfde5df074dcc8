#pragma once

// Counts durations in bins that grow by 2^(1/16) from 100 ns on: a percentile is right to 4.5 %. Adding allocates
// nothing. PLANT_STATUS carries it with one bin per octave.

#include <array>
#include <cstdint>
#include <vector>

namespace slewlab::sim {

class LatencyHistogram {
 public:
  static constexpr int kBinsPerOctave = 16;
  static constexpr int kOctaves = 28;  // 100 ns to 27 s

  void add(std::int64_t duration);  // [ns]; what is earlier than due counts as 0

  std::int64_t count() const { return count_; }
  std::int64_t largest() const { return largest_; }  // [ns]
  // [ns] that the given share of all durations does not exceed (upper edge of the bin); 0 without any.
  double percentile(double share) const;

  static double octave_edge(int octave);  // [ns] upper edge; the last is infinite
  std::int64_t octave_count(int octave) const;

 private:
  std::array<std::int64_t, kBinsPerOctave * kOctaves> bins_{};
  std::int64_t count_ = 0;
  std::int64_t largest_ = 0;
};

}  // namespace slewlab::sim
