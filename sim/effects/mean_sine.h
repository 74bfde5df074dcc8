// The mean of a sine over a step, so that what varies faster than the step does not fold down.
#pragma once

#include <cmath>

namespace slewlab::sim {

// Mean of sin over the span `turned` [rad] around `middle` [rad]: sin(middle) sin(turned / 2) / (turned / 2).
inline double mean_sine(double middle, double turned) {
  const double half = 0.5 * turned;
  const double share = std::fabs(half) < 1e-4 ? 1.0 - half * half / 6.0 : std::sin(half) / half;
  return std::sin(middle) * share;
}

}  // namespace slewlab::sim
