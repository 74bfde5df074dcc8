// A force on every mass that swings sideways: gravity's part across an inclined boom, or a moving frame.
#pragma once

#include "sim/integrate/plant_ports.h"

namespace slewlab::sim {

struct BodyMasses {
  double boom_per_length = 0.0;  // [kg/m]
  double load = 0.0;             // [kg]
  double rod_moment = 0.0;       // [kg m] M_l L_l / 2: a rod hung at its end
};

BodyMasses masses_of(const CraneParameters& crane);

// `lateral` [m/s^2] on boom, load and rod.
void add_body_force(const BodyMasses& masses, double lateral, PortForces& ports);

}  // namespace slewlab::sim
