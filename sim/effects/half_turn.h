// The mean of sines over a step's turn, so that what varies faster than the step does not fold down:
//   mean of sin(n a) over the span `turned` around m = sin(n m) sin(n h) / (n h),    h = turned / 2;    sin(2 h) / (2 h) = cos(h) sin(h) / h.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace slewlab::sim {

struct HalfTurn {
  double share;   // sin(h) / h
  double cosine;  // cos(h)
};

// Of a step that turns by `turned` [rad].
inline HalfTurn half_turn(double turned) {
  constexpr double kSmall = 0.5;  // [rad] up to which so many terms of the series leave less than is rounded, in a third of the time of two functions
  constexpr std::array<double, 7> kShare{1.0 / 6.0, 1.0 / 20.0, 1.0 / 42.0, 1.0 / 72.0, 1.0 / 110.0, 1.0 / 156.0, 1.0 / 210.0};
  constexpr std::array<double, 7> kCosine{1.0 / 2.0, 1.0 / 12.0, 1.0 / 30.0, 1.0 / 56.0, 1.0 / 90.0, 1.0 / 132.0, 1.0 / 182.0};
  const double half = 0.5 * turned, square = half * half;
  if (std::fabs(half) > kSmall) return {std::sin(half) / half, std::cos(half)};
  HalfTurn result{1.0, 1.0};
  for (std::size_t n = kShare.size(); n-- > 0;) result = {1.0 - square * kShare[n] * result.share, 1.0 - square * kCosine[n] * result.cosine};
  return result;
}

}  // namespace slewlab::sim
