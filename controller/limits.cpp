#include "controller/limits.h"

#include <algorithm>

namespace slewlab::controller {

double limited_torque(const TorqueLimits& limits, double period, double previous, double wanted) {
  const double largest_change = limits.rate * period;
  const double reachable = std::clamp(wanted, previous - largest_change, previous + largest_change);
  return std::clamp(reachable, -limits.torque, limits.torque);
}

}  // namespace slewlab::controller
