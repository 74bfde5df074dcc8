#include "sim/analysis/state_space.h"

#include <Eigen/Cholesky>
#include <utility>

#include "sim/model/boom.h"
#include "sim/model/drive_line.h"

namespace slewlab::sim {
namespace {

std::vector<NamedSignal> coordinates(const CraneParameters& crane, const CraneIndices& at, const std::string& turn) {
  std::vector<NamedSignal> names;
  for (int i = 0; i < at.group_count; ++i) names.push_back({"motors_" + std::to_string(i + 1), turn});
  names.push_back({"house", turn});
  const int boom_and_load = 3 * crane.boom.element_count + (at.rope >= 0 ? 1 : 0) + (at.rod >= 0 ? 1 : 0);
  if (at.size - at.house - 1 > boom_and_load) names.push_back({"house_top", turn});  // a house that gives
  for (int node = 1; node <= crane.boom.element_count; ++node) {
    const std::string number = '_' + std::to_string(node);
    names.push_back({"boom_deflection" + number, "m"});
    names.push_back({"boom_slope" + number, "rad"});
    names.push_back({"boom_twist" + number, "rad"});
  }
  if (at.rope >= 0) names.push_back({"rope_angle", "rad"});
  if (at.rod >= 0) names.push_back({"rod_angle", "rad"});
  return names;
}

// One row of C and D after the other, each with its name.
class Outputs {
 public:
  explicit Outputs(StateSpace& system) : system_(system) {}

  void add(std::string name, std::string unit, const Eigen::RowVectorXd& of_states, const Eigen::RowVectorXd& of_inputs) {
    const Eigen::Index row = system_.c.rows();
    system_.c.conservativeResize(row + 1, of_states.size());
    system_.d.conservativeResize(row + 1, of_inputs.size());
    system_.c.row(row) = of_states;
    system_.d.row(row) = of_inputs;
    system_.outputs.push_back({std::move(name), std::move(unit)});
  }

 private:
  StateSpace& system_;
};

}  // namespace

Eigen::MatrixXd drive_forces(const CraneParameters& crane, const CraneIndices& at) {
  const double per_group = crane.drive.motors_per_group * total_ratio(crane.drive);
  Eigen::MatrixXd forces = Eigen::MatrixXd::Zero(at.size, crane.drive.group_count);
  for (int i = 0; i < crane.drive.group_count; ++i) forces(crane.drive.is_rigid ? at.house : i, i) = per_group;
  return forces;
}

StateSpace state_space(const CraneParameters& crane, GearState gears, bool is_linear, bool is_shaft_linear) {
  const CraneMatrices matrices = assemble_crane(crane, gears);
  const CraneIndices& at = matrices.at;
  const int n = at.size, groups = crane.drive.group_count;
  const std::string turn = is_linear ? "m" : "rad", shaft = is_shaft_linear ? "m" : "rad";
  const Eigen::LLT<Eigen::MatrixXd> mass(matrices.mass);

  StateSpace system;
  system.a = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  system.a.topRightCorner(n, n).setIdentity();
  system.a.bottomLeftCorner(n, n) = -mass.solve(matrices.stiffness);
  system.a.bottomRightCorner(n, n) = -mass.solve(matrices.damping);
  system.b = Eigen::MatrixXd::Zero(2 * n, groups);
  system.b.bottomRows(n) = mass.solve(drive_forces(crane, at));
  system.states = coordinates(crane, at, turn);
  for (int i = 0; i < n; ++i) system.states.push_back({system.states[i].name + "_rate", system.states[i].unit + "/s"});
  for (int i = 0; i < groups; ++i) {
    system.inputs.push_back({"motor_torque_" + std::to_string(i + 1), is_shaft_linear ? "N" : "N m"});
  }

  Outputs outputs(system);
  const Eigen::RowVectorXd none = Eigen::RowVectorXd::Zero(groups);
  const auto state = [n](int index, double factor) {
    Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(2 * n);
    row(index) = factor;
    return row;
  };
  for (int i = 0; i < groups; ++i) {
    const int motor = crane.drive.is_rigid ? at.house : i;
    outputs.add("shaft_speed_" + std::to_string(i + 1), shaft + "/s", state(n + motor, total_ratio(crane.drive)), none);
  }
  outputs.add("slew_angle", turn, state(at.house, 1.0), none);
  outputs.add("slew_speed", turn + "/s", state(n + at.house, 1.0), none);
  if (crane.boom.length > 0.0) {
    const int tip = at.tip >= 0 ? at.tip : at.house;
    const double lever = at.tip >= 0 ? 1.0 : tip_radius(crane.boom);
    outputs.add("tip_velocity", "m/s", state(n + tip, lever), none);
    outputs.add("tip_acceleration", "m/s^2", lever * system.a.row(n + tip), lever * system.b.row(n + tip));
  }
  if (at.rope >= 0) outputs.add("rope_angle", "rad", state(at.rope, 1.0), none);
  return system;
}

}  // namespace slewlab::sim
