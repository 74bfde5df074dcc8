#include "sim/machine/plausibility.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>

#include "sim/analysis/eigen.h"
#include "sim/machine/scales.h"
#include "sim/model/boom.h"
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

// The clamped boom's slowest mode; four elements have it to a few per cent.
Mode slowest_of_boom(const BoomParameters& whole) {
  constexpr int kElements = 4;
  BoomParameters boom = whole;
  boom.element_count = std::min(boom.element_count, kElements);
  const std::vector<Mode> modes = clamped_boom_modes(boom);
  return modes.empty() ? Mode{} : modes.front();
}

// Values in the order in which they are judged.
class Judgement {
 public:
  // `what` has a place for the ratio. Whether it is within its limits.
  bool operator()(const std::string& key, double ratio, double least, double most, const char* what, const char* usual) {
    if (ratio >= least && ratio <= most) return true;
    found_.push_back({key, text(what, ratio), usual});
    return false;
  }
  std::vector<ImplausibleValue> found() { return std::move(found_); }

 private:
  std::vector<ImplausibleValue> found_;
};

constexpr const char* kLoadOfBooms = "a load of %.3g times the boom's mass";
constexpr const char* kUsualLoad = "a hundredth to five times";

void judge_load(const CraneParameters& machine, Judgement& judge) {
  const LoadParameters& load = machine.load;
  judge("load.mass", load.mass / machine.boom.mass, 0.0, 20.0, kLoadOfBooms, kUsualLoad);
  judge("load.rope_length", load.rope_length / machine.boom.length, 5e-3, 20.0, "a rope of %.3g times the boom's length",
        "a fiftieth to three times");
  judge("load.rod_length", load.rod_length / (load.rope_length + machine.boom.length), 0.0, 1.0,
        "a hook and load as long as %.3g times the rope and the boom", "up to a tenth");
}

// Paths of the drive's numbers in the machine's file.
struct DriveKeys {
  const char* inertia;
  const char* stiffness;
  const char* play;
};

void judge_gears(const CraneParameters& machine, const Scales& scales, double plant_step, const DriveKeys& keys, Judgement& judge) {
  judge(keys.inertia, (scales.axis_inertia - scales.driven_inertia) / scales.driven_inertia, 1e-4, 3e3,
        "motors with %.3g times the inertia of what they drive, both on the axis", "a thousandth to a thousand times");
  const double frequency = drive_frequency(machine);
  if (plant_step > 0.0) {
    judge(keys.stiffness, 1.0 / (frequency * plant_step), 12.0, HUGE_VAL, "motors that swing on their gears with %.3g plant steps to a period",
          "twenty and more; a shorter plant_step would do as well");
  }
  judge(keys.stiffness, frequency * scales.acceleration_time, 0.5, HUGE_VAL,
        "gears so soft that the motors swing %.3g times while the machine comes to its top speed", "twice and more");
  judge(keys.play, 2.0 * half_play(machine.drive) / (scales.top_speed * scales.acceleration_time), 0.0, 0.15,
        "a play of %.3g times what the axis moves at top speed in the time from rest to top speed", "up to a fiftieth");
}

void judge_drive(const CraneParameters& machine, const Scales& scales, double plant_step, Judgement& judge) {
  const DriveParameters& drive = machine.drive;
  const double with_load = scales.axis_inertia + machine.load.mass * scales.reach * scales.reach;
  judge("drive.rated_torque", with_load * scales.top_speed / scales.axis_torque, 1e-2, 1e3,
        "%.3g s from rest to top speed with the rated torque, the load included", "a tenth of a second to a minute");
  if (drive.brake_inertia > 0.0) {
    judge("drive.motor_inertia", drive.motor_inertia / drive.brake_inertia, 0.3, 3e3, "a rotor of %.3g times its brake's inertia", "three to a hundred times");
  }
  judge_gears(machine, scales, plant_step,
              {"drive.motor_inertia", "drive.gearbox_stiffness", drive.gearbox_play > drive.pinion_play ? "drive.gearbox_play" : "drive.pinion_play"}, judge);
}

// What the axis carries at rest: no motor holds more than it is rated for.
void judge_axis_load(const AxisForceParameters& load, double axis_torque, Judgement& judge) {
  judge("load.constant", std::fabs(load.constant) / axis_torque, 0.0, 1.0, "a constant load of %.3g times what the motor is rated for, on the axis", "up to a half");
  judge("load.gravity", std::fabs(load.gravity) / axis_torque, 0.0, 1.0, "gravity of %.3g times what the motor is rated for, on the axis", "up to a half");
}

void judge_axis(const MachineFile& file, const Scales& scales, double plant_step, Judgement& judge) {
  judge(file.axis.is_shaft_linear ? "rated_force" : "rated_torque", scales.acceleration_time, 1e-3, 60.0,
        file.axis.is_linear ? "%.3g s from rest to top speed: mass and top_speed against all that the motor is rated for"
                            : "%.3g s from rest to top speed: inertia and top_speed against all that the motor is rated for",
        "a hundredth of a second to ten seconds");
  judge_axis_load(file.parameters.axis_force, scales.axis_torque, judge);
  if (file.parameters.drive.is_rigid) return;
  judge_gears(file.parameters, scales, plant_step, {file.axis.is_shaft_linear ? "motor_mass" : "motor_inertia", "transmission.stiffness", "transmission.play"},
              judge);
}

void judge_boom(const CraneParameters& machine, const Scales& scales, Judgement& judge) {
  const BoomParameters& boom = machine.boom;
  // All the weight of a crane's house, near the axis, turns more easily than its boom.
  const double house = machine.house.inertia / (scales.driven_inertia - machine.house.inertia);
  const char *const house_of_booms = "a house of %.3g times the boom's inertia, both about the axis", *const usual_house = "a thousandth to a half";
  judge("house.inertia", house, 0.0, 1.0, house_of_booms, usual_house);
  const auto narrower = [](const BoomStation& a, const BoomStation& b) { return a.half_width < b.half_width; };
  const double narrowest = 2.0 * std::min_element(boom.profile.begin(), boom.profile.end(), narrower)->half_width;
  judge("boom.chord_outer_diameter", boom.chord_outer_diameter / narrowest, 0.0, 1.0, "chords %.3g times as thick as the boom is wide where it is narrowest",
        "a fiftieth to a third");
  const BoomStation middle = station_at(boom, 0.5);
  const double width = 2.0 * middle.half_width, height = 2.0 * middle.half_height;
  judge("boom.torsion_constant", boom.torsion_constant / (width * height * (width * width + height * height) / 12.0), 0.0, 1.0,
        "a torsion constant of %.3g times that of a block as large as the boom's middle", "a thousandth to a tenth");
  if (boom.element_count > 0) {
    const Mode slowest = slowest_of_boom(boom);
    const bool twists = slowest.kind == ModeKind::kTorsion;
    const bool is_stiff = judge(twists ? "boom.torsion_constant" : "boom.youngs_modulus", slowest.frequency * scales.acceleration_time, 0.2, 1e5,
                                twists ? "a boom that twists to and fro %.3g times while the machine comes to its top speed, by its torsion constant and shear modulus"
                                       : "a boom that swings %.3g times while the machine comes to its top speed",
                                "once to a hundred times");
    if (!is_stiff) return;
  }
  const double buckles = critical_buckling_force(boom.youngs_modulus, mean_second_moment(boom, 0.0, 1.0), boom.length);
  const bool is_boom_light = judge("boom.mass", boom.mass * kGravity / buckles, 0.0, 0.5, "a boom that weighs %.3g times what buckles it", "a thousandth to a twentieth");
  if (!is_boom_light) return;  // of a boom that is no boom the rest says nothing
  judge("house.inertia", house, 1e-4, HUGE_VAL, house_of_booms, usual_house);
  // Less than any hook.
  if (machine.load.mass > 0.0) judge("load.mass", machine.load.mass / boom.mass, 2e-3, HUGE_VAL, kLoadOfBooms, kUsualLoad);
}

// Below one period a drive trips between two commands; after a thousand it has long done what the last one asked for.
void judge_timeout(const char* key, std::int64_t timeout, std::int64_t controller_period, Judgement& judge) {
  if (timeout == kNever) return;
  const double periods = static_cast<double>(timeout) / static_cast<double>(controller_period);
  judge(key, periods, 1.0, 1000.0,
        periods < 1.0 ? "a time-out of %.3g controller periods, so that the drive trips between two commands"
                      : "a time-out of %.3g controller periods, for which the drive goes on with the last command",
        "three to a hundred");
}

void judge_protection(const DriveProtectionSettings& protection, double rated_torque, std::int64_t controller_period, Judgement& judge) {
  if (std::isfinite(protection.torque_limit)) {
    judge("drive_protection.torque_limit", protection.torque_limit / rated_torque, 0.05, 20.0, "a limit of %.3g times the rated torque",
          "once to three times");
  }
  if (protection.brake.torque > 0.0) {
    judge("drive_protection.brake.torque", protection.brake.torque / rated_torque, 0.1, 50.0, "brakes of %.3g times the rated torque",
          "once to three times");
  }
  if (controller_period <= 0) return;
  judge_timeout("drive_protection.alive_timeout", protection.alive_timeout, controller_period, judge);
  judge_timeout("drive_protection.silence_timeout", protection.silence_timeout, controller_period, judge);
}

}  // namespace

std::vector<ImplausibleValue> implausible_values(const MachineFile& file, const RunPeriods& periods) {
  const CraneParameters& machine = file.parameters;
  const Scales scales = scales_of(machine);
  const bool has_boom = machine.boom.length > 0.0 && machine.boom.mass > 0.0;
  Judgement judge;
  if (file.kind == MachineKind::axis) {
    judge_axis(file, scales, periods.plant_step, judge);
  } else {
    if (has_boom && machine.load.mass > 0.0) judge_load(machine, judge);
    judge_drive(machine, scales, periods.plant_step, judge);
    if (has_boom) judge_boom(machine, scales, judge);
    if (has_boom) {
      judge("house.sensor_radius", machine.house.sensor_radius / scales.reach, 0.0, 2.0, "an accelerometer on the house at %.3g times the boom's reach",
            "a fiftieth to a half");
    }
  }
  judge_protection(file.drive_protection, machine.drive.rated_torque, periods.controller_period, judge);
  return judge.found();
}

}  // namespace slewlab::sim
