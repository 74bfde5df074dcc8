#include "diagnosis/quiet_beginnings.h"

#include <algorithm>
#include <cmath>

namespace slewlab::diagnosis {

namespace {

constexpr double kFarSwing = 3.0;  // [standard deviations]: one machine in four hundred

}  // namespace

bool quieten_beginnings(const Nuisances& nuisances, Point& point) {
  bool is_far = false;
  const std::size_t own = nuisances.per_record(), first = nuisances.swing_amounts() + nuisances.offset_groups;
  for (std::size_t begin = nuisances.common_count(); own > 0 && begin + own <= point.nuisance.size(); begin += own) {
    const auto from = point.nuisance.begin() + static_cast<std::ptrdiff_t>(begin + first), to = point.nuisance.begin() + static_cast<std::ptrdiff_t>(begin + own);
    if (std::none_of(from, to, [](double amount) { return std::fabs(amount) > kFarSwing; })) continue;
    std::fill(from, to, 0.0);
    is_far = true;
  }
  return is_far;
}

}  // namespace slewlab::diagnosis
