#include "sim/machine/scales.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "sim/analysis/eigen.h"
#include "sim/model/boom.h"
#include "sim/model/crane.h"
#include "sim/model/drive_line.h"

namespace slewlab::sim {

namespace {

// Enough for the modes that matter: five bending modes stand within 0.5 % of a fine mesh (thesis Figure 4.3).
constexpr int kMeshOfScales = 16;
// Chosen: the period of the lowest mode and a third of it take about as long as the thesis's crane takes to top speed with its rated torque.
constexpr double kLowestModePeriods = 1.3;

std::vector<double> frequencies(const CraneParameters& machine, bool of_load) {
  CraneParameters meshed = machine;
  if (meshed.boom.element_count > 0) meshed.boom.element_count = kMeshOfScales;
  std::vector<double> found;
  for (const Mode& mode : crane_modes(meshed)) {
    if (mode.kind == ModeKind::kRigid || (mode.kind == ModeKind::kLoad) != of_load) continue;
    found.push_back(mode.frequency);
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace

Scales scales_of(const CraneParameters& machine) {
  Scales scales;
  const DriveParameters& drive = machine.drive;
  const double motors = static_cast<double>(drive.group_count) * drive.motors_per_group;
  scales.ratio = total_ratio(drive);
  scales.motor_torque = drive.rated_torque;
  scales.motor_inertia = drive_inertia(drive);
  scales.axis_torque = motors * drive.rated_torque * scales.ratio;
  scales.driven_inertia = driven_inertia(machine);
  scales.axis_inertia = motors * scales.motor_inertia * scales.ratio * scales.ratio + scales.driven_inertia;
  scales.top_speed = drive.top_speed;
  const bool is_usable = scales.axis_torque > 0.0 && scales.axis_inertia > 0.0 && scales.top_speed > 0.0;
  if (!is_usable) throw std::invalid_argument("a machine's scales need an inertia, a rated torque and a top speed, all above 0");
  scales.acceleration_time = scales.axis_inertia * scales.top_speed / scales.axis_torque;
  if (machine.boom.length > 0.0) {
    scales.reach = tip_radius(machine.boom);
    scales.boom_mass = machine.boom.mass;
  }
  return scales;
}

std::vector<double> structural_modes(const CraneParameters& machine, std::size_t most) {
  std::vector<double> modes = frequencies(machine, false);
  if (modes.size() > most) modes.resize(most);
  return modes;
}

double characteristic_time(const Scales& scales, const std::vector<double>& structural_modes) {
  if (structural_modes.empty()) return scales.acceleration_time;
  return std::max(scales.acceleration_time, kLowestModePeriods / structural_modes.front());
}

double characteristic_time(const CraneParameters& machine) { return characteristic_time(scales_of(machine), structural_modes(machine, 1)); }

std::vector<double> pendulum_modes(const CraneParameters& machine) { return frequencies(machine, true); }

}  // namespace slewlab::sim
