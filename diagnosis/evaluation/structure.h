// House and boom of a truth machine in modes, with what may be built differently: a slew ring that twists against
// the house, a pedestal that bends, a jib beside the boom's axis, an axial force. Each is a degree of freedom or a
// term of the finite elements here, where the catalogue (sim/effects) uses forces or changed parameters.
//
// Degrees of freedom: pedestal displacement y_p, ring, house, boom nodes from the second on [y, phi, psi], all
// lateral displacements against the ground. Without a change the modes are those of free_house_modes().
//
// - Axial force F towards the pivot: consistent geometric stiffness of a beam element, and the sideways part
//   F (y_tip - y_pivot) / L of a force that always points to the pivot. A clamped boom then buckles at
//   pi^2 E I / L^2, thesis (2.16).
// - Damping: mode k loses phi_k' C phi_k, C = a_1 K of the steel (3.15) plus the pedestal's.
#pragma once

#include <array>
#include <limits>
#include <vector>

#include "sim/model/crane.h"
#include "slewlab_msgs/signals.hpp"

namespace slewlab::diagnosis::withheld {

struct StructureChange {
  double ring_stiffness = std::numeric_limits<double>::infinity();      // [Nm/rad] between slew ring and house
  double ring_inertia_share = 0.2;                                      // [-] of the house's inertia, on the ring
  double pedestal_stiffness = std::numeric_limits<double>::infinity();  // [N/m] lateral
  double pedestal_mass = 0.0;           // [kg] house and pedestal that move sideways
  double pedestal_damping_ratio = 0.0;  // [-]
  double jib_mass = 0.0;                // [kg] at the tip, `jib_eccentricity` beside the boom's axis
  double jib_eccentricity = 0.0;        // [m] of the jib and of the rope's sheave
  double axial_force = 0.0;             // [N] compression
  double damping_factor = 1.0;          // [-] on the steel's damping at `damping_pivot`
  double damping_power = 0.0;           // [-] damping goes with (omega / damping_pivot)^power besides
  double damping_pivot = 1.0;           // [rad/s]
};

struct Structure {
  sim::FreeHouseModes modes;  // house: the ring that the pinions push; tip: where the rope leaves
  // What each field of SENSORS feels of each mode: [m] lateral of an acceleration, [rad] of an angle.
  std::array<std::vector<double>, msgs::kSensorFields<msgs::SensorReadings>.size()> sensors;
};

// Throws std::invalid_argument where the crane cannot be built or the axial force buckles the boom.
Structure make_structure(const sim::CraneParameters& crane, const StructureChange& change);

}  // namespace slewlab::diagnosis::withheld
