// One value per motor group.
#pragma once

#include <array>

namespace slewlab::controller {

inline constexpr int kMaximumGroups = 8;

using PerGroup = std::array<double, kMaximumGroups>;

}  // namespace slewlab::controller
