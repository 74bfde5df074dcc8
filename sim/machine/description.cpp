#include "sim/machine/description.h"

#include <algorithm>
#include <cmath>

namespace slewlab::sim {

namespace {

using common::Unit;

// Noise of ordinary sensors, chosen: industrial accelerometers of 0.5 mg over their band; the speed a drive reports from
// 14 bits a turn. A count is known by the record itself.
constexpr double kAccelerationNoise = 0.005;  // [m/s^2]
constexpr double kAccelerationCorner = 50.0;  // [Hz] of 1/f noise, as data sheets of such accelerometers give it
constexpr double kSpeedNoise = 0.02;          // [rad/s]
constexpr double kSlewAngleNoise = 2.4e-5;    // [rad] 18 bits on the slew ring

std::string of_group(std::string_view what, int group, int count) {
  return count == 1 ? std::string(what) : std::string(what) + " of group " + std::to_string(group + 1);
}

std::vector<Effort> efforts_of(const CraneParameters& machine, const Scales& scales) {
  std::vector<Effort> efforts;
  const int groups = machine.drive.group_count;
  for (int group = 0; group < groups; ++group) {
    efforts.push_back({of_group("motor torque", group, groups), Unit::newton_metre, EffortPlace::motor_group, group, scales.motor_torque});
  }
  efforts.push_back({"torque on the axis", Unit::newton_metre, EffortPlace::axis, -1, scales.axis_torque});
  if (scales.reach > 0.0) {
    const double force = scales.axis_torque / scales.reach;
    efforts.push_back({"force at the tip", Unit::newton, EffortPlace::tip, -1, force});
    efforts.push_back({"load along the boom", Unit::newton_per_metre, EffortPlace::boom, -1, force / machine.boom.length});
  }
  if (machine.load.mass > 0.0) {
    efforts.push_back({"force at the load", Unit::newton, EffortPlace::load, -1, machine.load.mass * kGravity});
  }
  return efforts;
}

std::vector<Sensor> sensors_of(const CraneParameters& machine) {
  std::vector<Sensor> sensors;
  const int groups = machine.drive.group_count;
  for (int group = 0; group < groups; ++group) {
    sensors.push_back({of_group("shaft speed", group, groups), Unit::radian_per_second, "ENCODER", "shaft_speed", SensorPlace::motor_group, group, 0.0, kSpeedNoise});
    sensors.push_back({of_group("shaft position", group, groups), Unit::radian, "ENCODER", "shaft_position", SensorPlace::motor_group, group, 0.0, 0.0});
  }
  const BoomParameters& boom = machine.boom;
  const auto accelerometer = [&](std::string name, std::string_view field, SensorPlace place, double radius) {
    sensors.push_back({std::move(name), Unit::metre_per_second_squared, "SENSORS", field, place, -1, radius, kAccelerationNoise, kAccelerationCorner});
  };
  if (machine.house.sensor_radius > 0.0) {
    accelerometer("house acceleration", "house_acceleration", SensorPlace::house, machine.house.sensor_radius);
  }
  if (boom.length > 0.0) {
    const double level = boom.length * std::cos(boom.angle);
    accelerometer("pivot acceleration", "pivot_acceleration", SensorPlace::pivot, boom.pivot_radius);
    accelerometer("middle acceleration", "middle_acceleration", SensorPlace::middle, boom.pivot_radius + 0.5 * level);
    accelerometer("tip acceleration", "tip_acceleration", SensorPlace::tip, boom.pivot_radius + level);
  }
  sensors.push_back({"slew angle", Unit::radian, "SENSORS", "slew_angle", SensorPlace::axis, -1, 0.0, kSlewAngleNoise});
  return sensors;
}

// All that a crane may have; a machine has those of which a number is not 0.
std::vector<Parameter> all_parameters() {
  using C = CraneParameters;
  return {
      {"drive inertia", kUnitDeviation,
       {{"drive", "motor_inertia", Unit::kilogram_square_metre, [](C& c) -> double& { return c.drive.motor_inertia; }},
        {"drive", "brake_inertia", Unit::kilogram_square_metre, [](C& c) -> double& { return c.drive.brake_inertia; }},
        {"drive", "gearbox_inertia", Unit::kilogram_square_metre, [](C& c) -> double& { return c.drive.gearbox_inertia; }}}},
      {"gearbox stiffness", kUnitDeviation,
       {{"drive", "gearbox_stiffness", Unit::newton_metre_per_radian, [](C& c) -> double& { return c.drive.gearbox_stiffness; }}}},
      {"gear damping", kUnitDeviation,
       {{"drive", "gear_damping_ratio", Unit::none, [](C& c) -> double& { return c.drive.gear_damping_ratio; }}}},
      {"play", kUnitDeviation,
       {{"drive", "gearbox_play", Unit::radian, [](C& c) -> double& { return c.drive.gearbox_play; }},
        {"drive", "pinion_play", Unit::radian, [](C& c) -> double& { return c.drive.pinion_play; }}}},
      {"house inertia", kUnitDeviation,
       {{"house", "inertia", Unit::kilogram_square_metre, [](C& c) -> double& { return c.house.inertia; }}}},
      {"house sensor radius", kUnitDeviation,
       {{"house", "sensor_radius", Unit::metre, [](C& c) -> double& { return c.house.sensor_radius; }}}},
      {"boom mass", kUnitDeviation, {{"boom", "mass", Unit::kilogram, [](C& c) -> double& { return c.boom.mass; }}}},
      {"boom bending stiffness", kUnitDeviation,
       {{"boom", "youngs_modulus", Unit::pascal, [](C& c) -> double& { return c.boom.youngs_modulus; }}}},
      {"boom torsional stiffness", kUnitDeviation,
       {{"boom", "torsion_constant", Unit::metre_to_the_fourth, [](C& c) -> double& { return c.boom.torsion_constant; }}}},
      {"boom damping", kUnitDeviation, {{"boom", "damping_ratio", Unit::none, [](C& c) -> double& { return c.boom.damping_ratio; }}}},
      {"boom angle", kUnitDeviation, {{"boom", "angle", Unit::radian, [](C& c) -> double& { return c.boom.angle; }}}},
      {"pivot radius", kUnitDeviation, {{"boom", "pivot_radius", Unit::metre, [](C& c) -> double& { return c.boom.pivot_radius; }}}},
      {"load mass", kUnitDeviation, {{"load", "mass", Unit::kilogram, [](C& c) -> double& { return c.load.mass; }}}},
      {"rope length", kUnitDeviation, {{"load", "rope_length", Unit::metre, [](C& c) -> double& { return c.load.rope_length; }}}},
      {"rod length", kUnitDeviation, {{"load", "rod_length", Unit::metre, [](C& c) -> double& { return c.load.rod_length; }}}},
      {"load damping", kUnitDeviation, {{"load", "damping_ratio", Unit::none, [](C& c) -> double& { return c.load.damping_ratio; }}}},
  };
}

std::vector<Parameter> parameters_of(CraneParameters machine) {
  std::vector<Parameter> parameters = all_parameters();
  std::erase_if(parameters, [&](const Parameter& parameter) {
    const bool has_any = std::any_of(parameter.numbers.begin(), parameter.numbers.end(),
                                     [&](const FileNumber& number) { return number.of(machine) != 0.0; });
    const bool is_of_load = parameter.numbers.front().section == "load";
    return !has_any || (is_of_load && machine.load.mass == 0.0);
  });
  return parameters;
}

}  // namespace

MachineDescription describe(const CraneFile& file) { return describe(file.parameters); }

MachineDescription describe(const CraneParameters& machine) {
  MachineDescription description;
  description.kind = "crane";
  description.machine = machine;
  description.scales = scales_of(machine);
  description.efforts = efforts_of(machine, description.scales);
  description.sensors = sensors_of(machine);
  description.parameters = parameters_of(machine);
  return description;
}

}  // namespace slewlab::sim
