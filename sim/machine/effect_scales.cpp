#include "sim/machine/effect_scales.h"

#include <algorithm>
#include <cmath>

#include "sim/machine/scales.h"
#include "sim/model/drive_line.h"

namespace slewlab::sim {

common::EffectScales effect_scales(const CraneParameters& nominal, const DriveProtectionSettings& protection) {
  using common::ScaleOf;
  const Scales machine = scales_of(nominal);
  common::EffectScales scales;
  scales[ScaleOf::time] = machine.acceleration_time;
  scales[ScaleOf::motor_torque] = machine.motor_torque;
  scales[ScaleOf::drive_torque] = std::min(machine.motor_torque, protection.torque_limit);
  scales[ScaleOf::motor_speed] = machine.top_speed * machine.ratio;
  scales[ScaleOf::axis_torque] = machine.axis_torque;
  scales[ScaleOf::axis_speed] = machine.top_speed;
  scales[ScaleOf::axis_angle] = machine.top_speed * machine.acceleration_time;
  scales[ScaleOf::axis_damping] = machine.axis_torque / machine.top_speed;
  if (parts_of(nominal).gears) {
    scales[ScaleOf::gear_stiffness] = nominal.drive.group_count * group_stiffness(nominal.drive);
    scales[ScaleOf::gearbox_stiffness] = nominal.drive.gearbox_stiffness;
    scales[ScaleOf::gear_windup] = machine.axis_torque / scales[ScaleOf::gear_stiffness];
  }
  if (machine.reach > 0.0) {
    scales[ScaleOf::swing_time] = std::sqrt(machine.reach / kGravity);
    scales[ScaleOf::length] = machine.reach;
    scales[ScaleOf::velocity] = machine.reach * machine.top_speed;
    scales[ScaleOf::wind_speed] = std::sqrt(kGravity * machine.reach);
    scales[ScaleOf::mass] = machine.axis_inertia / (machine.reach * machine.reach);
    scales[ScaleOf::force] = machine.axis_torque / machine.reach;
    scales[ScaleOf::lateral_damping] = scales[ScaleOf::mass] / machine.acceleration_time;
    scales[ScaleOf::lateral_stiffness] = scales[ScaleOf::lateral_damping] / machine.acceleration_time;
    scales[ScaleOf::drag_area] = scales[ScaleOf::force] / (0.5 * kAirDensity * kGravity * machine.reach);
  }
  return scales;
}

common::MachineParts parts_of(const CraneParameters& machine) {
  return {.gears = !machine.drive.is_rigid && machine.drive.gearbox_stiffness > 0.0 && std::isfinite(machine.drive.gearbox_stiffness),
          .boom = machine.boom.length > 0.0,
          .flexible_boom = machine.boom.length > 0.0 && machine.boom.element_count > 0,
          .load = machine.load.mass > 0.0,
          .pinion_teeth = machine.drive.pinion_teeth > 0,
          .gearbox_teeth = machine.drive.gearbox_ring_teeth > 0,
          .groups = machine.drive.group_count};
}

}  // namespace slewlab::sim
