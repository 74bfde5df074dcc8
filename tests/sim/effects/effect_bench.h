// Machines small enough for closed forms, and runs of them with one effect.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/effects/effect.h"
#include "sim/integrate/machine_settings.h"

namespace slewlab::sim {

// The thesis's crane, and parts of it.
CraneParameters flexible_crane();  // all of it, 6 elements
CraneParameters rigid_crane();     // boom as a rigid inertia, no load
CraneParameters rigid_crane_without_play();  // and gears that settle within a second
CraneParameters rigid_crane_with_load(double rod_length = 0.0);
// The same on a house so heavy that it stays where it is: the load alone.
CraneParameters pendulum(double mass = 30e3, double rope_length = 60.0);
// Rigid crane whose house stays where it is and whose gears settle within a second: for wound-up gears.
CraneParameters fixed_house();

// [kg m^2] whole rigid crane with its motors on the slew axis; of the rigid boom and house alone.
double whole_inertia(const CraneParameters& crane);
double house_and_boom_inertia(const CraneParameters& crane);
// [Nm] on the slew axis from one Nm of one motor; [Nm/rad], [rad] of a group on the slew axis.
double torque_factor(const CraneParameters& crane);
double group_gear_stiffness(const CraneParameters& crane);
double group_half_play(const CraneParameters& crane);

struct BenchSample {
  double time = 0.0;  // [s] end of the step
  PlantReadings readings;
  GroupArray applied_torque{};  // [Nm] per motor, behind the actuator path, of the step
  GroupArray motor_angle{}, motor_speed{}, gear_torque{}, deflection{};  // slew axis
  double house_angle = 0.0, house_speed = 0.0;
  double tip_displacement = 0.0;
  double load_displacement = 0.0, load_velocity = 0.0, rope_angle = 0.0, rod_angle = 0.0;
};

struct BenchStart {
  double slew_speed = 0.0;   // [rad/s] of everything, load and motors included
  double rope_angle = 0.0;   // [rad]
  GroupArray gear_torque{};  // [Nm] on the house per group, gears wound up for it
  std::optional<double> outwards = std::nullopt;  // [rad] where effects begin in that motion: OutwardSwing's angle
};

// [J] of motion, house and boom and the motors; and what of it is gone from one moment to another.
double energy_of_motion(const CraneParameters& crane, const BenchSample& sample);
double motion_lost(const CraneParameters& crane, const BenchSample& from, const BenchSample& to);

using Drive = std::function<DriveCommand(double time)>;
DriveCommand no_drive(double time);
Drive constant_drive(double first, double second);  // [Nm] per motor of groups 1, 2

// Samples at every step's end.
std::vector<BenchSample> run(const MachineSettings& settings, double duration, const Drive& drive = no_drive,
                             const BenchStart& start = {});
// One effect on a crane at 1 ms.
std::vector<BenchSample> run(const CraneParameters& crane, const std::string& effect,
                             const std::vector<double>& values, double duration,
                             const Drive& drive = no_drive, const BenchStart& start = {});

// The effect with its numbers for the thesis's crane.
const common::EffectAbout& thesis_effect(std::string_view name);
// Started by itself on a model, with values in the order of its parameters.
std::unique_ptr<RunningEffect> started(const std::string& effect, const std::vector<double>& values, const PlantModel& model,
                                       std::uint64_t seed = 0);

// What it makes of a machine before assembly.
void change_by(const std::string& effect, const std::vector<double>& values, MachineParameters& parameters);

// [s] mean time between rising zero crossings of the values, linear between samples.
double period_of(const std::vector<BenchSample>& samples,
                 const std::function<double(const BenchSample&)>& value);

}  // namespace slewlab::sim
