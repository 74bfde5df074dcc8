// The whole crane assembled from drive line, boom and load (thesis 3.6), as full matrices for analysis and
// for the reference, and the boom on its free house in modal coordinates for the fixed step.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "sim/model/crane_parameters.h"
#include "sim/model/gear.h"
#include "sim/model/load.h"

namespace slewlab::sim {

// Where each degree of freedom stands in the assembled matrices: motor groups (slew axis), house, boom nodes
// from the second on, load. -1 where the machine has none. A rigid drive has no motor groups of its own here: the
// motors turn with the house. Where the house is not rigid, `house` is the slew
// ring and the house's upper part comes right behind it.
struct CraneIndices {
  int group_count = 0;
  int house = 0;
  int tip = -1;       // y of the last boom node
  int tip_twist = -1; // psi of the last boom node
  int rope = -1;      // beta_1
  int rod = -1;       // beta_2
  int size = 0;
};

enum class GearState { kClosed, kOpen };

// Mass, stiffness and damping matrix of the whole crane (Figure 3.21), linear: all gears in contact, or all
// open. With a rigid boom the tip moves with the house and the load hangs on the house's rotation.
struct CraneMatrices {
  Eigen::MatrixXd mass;
  Eigen::MatrixXd stiffness;
  Eigen::MatrixXd damping;
  CraneIndices at;
};
CraneMatrices assemble_crane(const CraneParameters& crane, GearState gears);

// [kg m^2] house and rigid boom about the slew axis; what the motors drive, the load left out.
double driven_inertia(const CraneParameters& crane);

// [kg m^2] all that turns with the slew axis as one body where the drive is rigid: motors, house and boom.
double rigid_inertia(const CraneParameters& crane);

// [Nm] on the axis at `angle` [rad].
inline double axis_force_at(const AxisForceParameters& force, double angle) {
  return force.constant + force.gravity * std::cos(angle - force.gravity_angle);
}

// Contact of one group's gears on the slew axis, with the damping that driven_inertia() gives.
GearContact gear_contact(const CraneParameters& crane);

// The boom on its free house, without load and gears: mass-normalised modes, the first one the rigid rotation
// (frequency 0); where the drive is rigid, without the motors too. Mode k obeys q'' + damping_rate q' + frequency^2 q = sum over ports of shape * force.
// A rigid boom has the rigid mode alone; modes above boom.highest_frequency are left out, and with them what they bend
// under a steady force. Signs: the tip (without a boom: the house) moves to the positive side.
struct FreeHouseModes {
  std::vector<double> frequency;     // [rad/s]
  std::vector<double> damping_rate;  // [1/s] a_1 frequency^2
  std::vector<double> house;         // [rad] house rotation in the mode, where the gears push on the slew ring
  std::vector<double> pivot;         // [rad] house rotation at the boom's pivot; the same where it is rigid
  std::vector<double> tip;           // [m] lateral displacement of the tip, of the jib's sheave where there is one
  std::vector<double> middle;        // [m] at half of the length
  std::vector<double> tip_twist;     // [rad]
  std::vector<double> uniform_load;  // [m m] integral of the lateral displacement over the boom's length
  Eigen::MatrixXd shear;             // [N] element (row) by mode (column)
};
FreeHouseModes free_house_modes(const CraneParameters& crane);

}  // namespace slewlab::sim
