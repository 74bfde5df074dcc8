// The operator's hand: what he asks for from `time` on.
#pragma once

#include <cstdint>

namespace slewlab::sim {

struct OperatorMove {
  std::int64_t time = 0;       // [ns]
  double speed_request = 0.0;  // [-] -1 ... 1 of top speed
  bool emergency_stop = false;
  bool acknowledge = false;
};

}  // namespace slewlab::sim
