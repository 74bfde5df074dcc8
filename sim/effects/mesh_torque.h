// What a mesh whose stiffness goes up and down adds to the gears' torque.
#pragma once

#include <algorithm>

#include "sim/model/gear.h"

namespace slewlab::sim {

// [Nm] on the house, against the motor: the contact (gear.h) at the stiffness k (1 + share), not below 0, less the one
// at k. The contact keeps its damping, and its teeth never pull at either stiffness.
inline double mesh_torque(const GearContact& gear, double share, double deflection, double deflection_rate) {
  GearContact changed = gear;
  changed.stiffness *= std::max(0.0, 1.0 + share);
  return contact_torque(changed, deflection, deflection_rate) - contact_torque(gear, deflection, deflection_rate);
}

}  // namespace slewlab::sim
