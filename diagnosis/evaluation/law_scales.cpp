#include "diagnosis/evaluation/law_scales.h"

#include <cmath>

#include "sim/model/boom.h"
#include "sim/model/drive_line.h"

namespace slewlab::diagnosis::withheld {

namespace {

// Share of a lattice boom's outline, length by mean width, that drags in the wind: chords and bracing of both walls, round
// tubes. Chosen, within what DIN EN 13001-2 gives for lattices of tubes.
constexpr double kDragShare = 0.642;
constexpr double kLoadArea = 0.25;         // [-] of the boom's: chosen
constexpr double kRampOverRated = 4.4;     // [-] ramp time over the shortest possible, where no controller is known: chosen
constexpr int kWidthStations = 200;        // midpoints for the mean width

double mean_half_width(const sim::BoomParameters& boom) {
  double sum = 0.0;
  for (int k = 0; k < kWidthStations; ++k) sum += sim::station_at(boom, (k + 0.5) / kWidthStations).half_width;
  return sum / kWidthStations;
}

}  // namespace

LawScales law_scales(const sim::CraneParameters& nominal, const controller::ControllerSettings& controller) {
  LawScales scales;
  scales.machine = sim::scales_of(nominal);
  const sim::Scales& machine = scales.machine;
  const std::vector<double> modes = sim::structural_modes(nominal, 1);
  scales.period = modes.empty() ? machine.acceleration_time : 1.0 / modes.front();
  const double ramp = controller.ramp.acceleration_time;
  scales.ramp_time = ramp > 0.0 ? ramp : kRampOverRated * machine.acceleration_time;
  scales.stretch = scales.ramp_time / kWrittenForRamp;
  scales.top_shaft_speed = machine.top_speed * machine.ratio;
  scales.gear_stiffness = nominal.drive.group_count * sim::group_stiffness(nominal.drive);
  scales.group_share = 1.0 / nominal.drive.group_count;
  scales.gearbox_stiffness = nominal.drive.gearbox_stiffness;
  scales.wind_up = machine.axis_torque / scales.gear_stiffness;
  if (nominal.house.inertia > 0.0) scales.inertia_factor = machine.axis_inertia / nominal.house.inertia;
  if (machine.reach > 0.0) {
    const sim::BoomParameters& boom = nominal.boom;
    scales.drive_pedestal = scales.gear_stiffness / (machine.reach * machine.reach);
    scales.tip_force = machine.axis_torque / machine.reach;
    scales.tip_speed = machine.reach * machine.top_speed;
    scales.boom_length = boom.length;
    const double rigidity = boom.youngs_modulus * sim::mean_second_moment(boom, 0.0, 1.0);
    const double stiffness = sim::lateral_stiffness(boom.youngs_modulus, rigidity / boom.youngs_modulus, boom.length);
    scales.buckling_force = sim::critical_buckling_force(1.0, rigidity, boom.length);
    scales.guy = stiffness * stiffness * stiffness / (scales.tip_force * scales.tip_force);
    scales.boom_area = kDragShare * 2.0 * mean_half_width(boom) * boom.length;
    scales.load_area = kLoadArea * scales.boom_area;
    scales.wind_speed = std::sqrt(scales.tip_force / (0.5 * kAirDensity * scales.boom_area));
    scales.drag_area = scales.tip_force / (0.5 * kAirDensity * sim::kGravity * machine.reach);
    scales.wave_time = std::sqrt(machine.reach / sim::kGravity);
    const double radius_by_time = machine.reach * machine.acceleration_time;
    scales.sideways_stiffness = machine.axis_inertia / (radius_by_time * radius_by_time);
  }
  if (nominal.load.mass > 0.0) {
    scales.load_weight = nominal.load.mass * sim::kGravity;
    scales.rope_length = nominal.load.rope_length;
    scales.rope_stiffness = scales.load_weight / scales.rope_length;
    scales.swing_time = std::sqrt(scales.rope_length / sim::kGravity);
  }
  return scales;
}

}  // namespace slewlab::diagnosis::withheld
