// What is possible in a machine's file and yet most likely a slip: values far from the machine's own others. Ratios alone
// are judged, so that a machine of any scale is judged alike; what is usual is a wide margin about the cranes and axes that
// exist. Nothing here is refused.
#pragma once

#include <string>
#include <vector>

#include "sim/model/crane_parameters.h"

namespace slewlab::sim {

struct ImplausibleValue {
  std::string key;     // path in the machine's file, dots between
  std::string found;   // the value against what it was measured by
  std::string usual;
};

// `plant_step` in [s]; 0 where none is known yet. Throws std::invalid_argument where scales_of() does.
std::vector<ImplausibleValue> implausible_values(const CraneParameters& machine, double plant_step);

}  // namespace slewlab::sim
