// The linear machine in first order, x' = A x + B u, y = C x + D u, for control design: all gears in contact, or all open.
//
// States: every coordinate of the assembled matrices (sim/model/crane.h), then their rates. Inputs: torque per motor of
// each group on the fast axis. Outputs: what sensors show of it.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "sim/model/crane.h"

namespace slewlab::sim {

struct NamedSignal {
  std::string name;
  std::string unit;
};

struct StateSpace {
  Eigen::MatrixXd a, b, c, d;
  std::vector<NamedSignal> states, inputs, outputs;
};

// Generalised force per torque [Nm] on one motor of each group (column), in the order of the matrices.
Eigen::MatrixXd drive_forces(const CraneParameters& crane, const CraneIndices& at);

// `is_linear`: a linear axis, whose angles read [m] and torques on the axis [N]; `is_shaft_linear`: its motor too.
StateSpace state_space(const CraneParameters& crane, GearState gears = GearState::kClosed, bool is_linear = false,
                       bool is_shaft_linear = false);

}  // namespace slewlab::sim
