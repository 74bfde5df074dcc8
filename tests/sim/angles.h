// Angles as people write them, in radians.
#pragma once

#include <numbers>

namespace slewlab::sim {

inline constexpr double kTwoPi = 2.0 * std::numbers::pi;               // [rad] a turn
inline constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;  // [rad]

}  // namespace slewlab::sim
