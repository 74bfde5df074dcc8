#include "sim/machine/plausibility.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "sim/analysis/eigen.h"
#include "sim/machine/scales.h"
#include "sim/model/crane.h"
#include "sim/model/drive_line.h"

namespace slewlab::sim {
namespace {

std::string text(const char* format, double value) {
  char line[160];
  std::snprintf(line, sizeof line, format, value);
  return line;
}

// [Hz] of all motors on closed gears against what they drive.
double drive_frequency(const CraneParameters& machine) {
  const double groups = machine.drive.group_count;
  const double inertia = series_inertia(groups * group_inertia(machine.drive), driven_inertia(machine));
  return std::sqrt(groups * group_stiffness(machine.drive) / inertia) / (2.0 * std::numbers::pi);
}

// [Hz] of the clamped boom's slowest mode; four elements have it to a few per cent.
double boom_frequency(const CraneParameters& machine) {
  constexpr int kElements = 4;
  BoomParameters boom = machine.boom;
  boom.element_count = std::min(boom.element_count, kElements);
  const std::vector<Mode> modes = clamped_boom_modes(boom);
  return modes.empty() ? 0.0 : modes.front().frequency;
}

}  // namespace

std::vector<ImplausibleValue> implausible_values(const CraneParameters& machine, double plant_step) {
  const Scales scales = scales_of(machine);
  const bool has_boom = machine.boom.length > 0.0 && machine.boom.mass > 0.0;
  const LoadParameters& load = machine.load;
  std::vector<ImplausibleValue> found;
  const auto judge = [&](const char* key, double ratio, double least, double most, const char* what, const char* usual) {
    if (ratio >= least && ratio <= most) return;
    found.push_back({key, text(what, ratio), usual});
  };

  if (has_boom && load.mass > 0.0) {
    judge("load.mass", load.mass / machine.boom.mass, 0.0, 20.0, "a load of %.3g times the boom's mass", "a hundredth to five times");
    judge("load.rope_length", load.rope_length / machine.boom.length, 1e-3, 20.0, "a rope of %.3g times the boom's length",
          "a fiftieth to three times");
  }
  judge("drive.motor_inertia", (scales.axis_inertia - scales.driven_inertia) / scales.driven_inertia, 1e-4, 1e5,
        "motors with %.3g times the inertia of what they drive, both on the axis", "a hundredth to a hundred times");
  const double with_load = scales.axis_inertia + load.mass * scales.reach * scales.reach;
  judge("drive.rated_torque", with_load * scales.top_speed / scales.axis_torque, 1e-3, 1e3,
        "%.3g s from rest to top speed with the rated torque, the load included", "a tenth of a second to a minute");
  const double frequency = drive_frequency(machine);
  if (plant_step > 0.0) {
    judge("drive.gearbox_stiffness", 1.0 / (frequency * plant_step), 12.0, HUGE_VAL,
          "motors that swing on their gears with %.3g plant steps to a period", "twenty and more; a shorter plant_step would do as well");
  }
  judge("drive.gearbox_stiffness", frequency * scales.acceleration_time, 0.5, HUGE_VAL,
        "gears so soft that the motors swing %.3g times while the machine comes to its top speed", "twice and more");
  if (has_boom && machine.boom.element_count > 0) {
    judge("boom.youngs_modulus", boom_frequency(machine) * scales.acceleration_time, 0.2, 1e5,
          "a boom that swings %.3g times while the machine comes to its top speed", "once to a hundred times");
  }
  return found;
}

}  // namespace slewlab::sim
