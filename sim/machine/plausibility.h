// What is possible in a machine's file and yet most likely a slip: values far from the machine's own others. Ratios alone
// are judged, so that a machine of any scale is judged alike; what is usual is a wide margin about the cranes and axes that
// exist. Nothing here is refused.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/machine/machine_file.h"

namespace slewlab::sim {

struct ImplausibleValue {
  std::string key;     // path in the machine's file, dots between
  std::string found;   // the value against what it was measured by
  std::string usual;
};

// What a machine runs with; 0 where that is not known yet.
struct RunPeriods {
  double plant_step = 0.0;               // [s]
  std::int64_t controller_period = 0;    // [ns]
};

// Of a crane, or of an axis, of which less is usual. Throws std::invalid_argument where scales_of() does.
std::vector<ImplausibleValue> implausible_values(const MachineFile& machine, const RunPeriods& periods);

}  // namespace slewlab::sim
