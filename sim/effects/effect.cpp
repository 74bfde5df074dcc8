#include "sim/effects/effect.h"

namespace slewlab::sim {

double group_side(int group, int group_count) {
  const int twice = 2 * group + 1;
  return twice < group_count ? 1.0 : twice > group_count ? -1.0 : 0.0;
}

}  // namespace slewlab::sim
