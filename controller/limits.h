// Limits on the torque command of one motor: its size and how fast it may change.
#pragma once

namespace slewlab::controller {

struct TorqueLimits {
  double torque = 0.0;       // [N m] per motor, largest size
  double rate = 0.0;         // [N m/s] per motor, largest change; infinite is no limit
};

// The wanted torque brought within the limits, `period` [s] after `previous` [N m] was commanded.
double limited_torque(const TorqueLimits& limits, double period, double previous, double wanted);

}  // namespace slewlab::controller
