#include "sim/machine/description.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <slewlab_msgs/signals.hpp>
#include <stdexcept>

#include "sim/model/boom.h"

namespace slewlab::sim {

namespace {

using common::Unit;

// Noise of ordinary sensors, chosen, where the machine's file has no other (`sensors:`). A count is known by the record itself.
constexpr double kAccelerationNoise = 0.005;  // [m/s^2] industrial accelerometers of 0.5 mg over their band
constexpr double kAccelerationCorner = 50.0;  // [Hz] of 1/f noise, as data sheets of such accelerometers give it
constexpr double kSpeedNoise = 1.5e-4;        // [-] of the motor's top speed: 0.02 rad/s of an asynchronous motor of four poles at 50 Hz
constexpr double kAngleNoise = 2.4e-5;        // [rad] 18 bits on the slew ring
constexpr double kScaleNoise = 1e-6;          // [m] of a glass scale

double known_or(double known, double ordinary) { return known > 0.0 ? known : ordinary; }

double motor_speed_noise(const CraneParameters& machine, const Scales& scales) {
  return known_or(machine.sensors.motor_speed_noise, kSpeedNoise * scales.ratio * scales.top_speed);
}

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

constexpr std::array<std::string_view, 6> kPlaces{"motor_group", "axis", "house", "pivot", "middle", "tip"};

// [m] from the axis.
double radius_of(const CraneParameters& machine, SensorPlace place) {
  const BoomParameters& boom = machine.boom;
  switch (place) {
    case SensorPlace::house: return machine.house.sensor_radius;
    case SensorPlace::pivot: return boom.pivot_radius;
    case SensorPlace::middle: return boom_point(boom, 0.5).radius;
    case SensorPlace::tip: return tip_radius(boom);
    default: return 0.0;
  }
}

Sensor sensor_of(const msgs::Signal& signal, const CraneParameters& machine, const Scales& scales) {
  Sensor sensor;
  sensor.name = signal.field;
  std::replace(sensor.name.begin(), sensor.name.end(), '_', ' ');
  sensor.unit = common::unit_of(signal.unit).value();
  sensor.channel = signal.channel;
  sensor.field = signal.field;
  sensor.place = place_named(signal.place);
  const bool counts = sensor.place == SensorPlace::motor_group;
  switch (sensor.unit) {
    case Unit::metre_per_second_squared:
      sensor.radius = radius_of(machine, sensor.place);
      sensor.noise_floor = known_or(machine.sensors.acceleration_noise, kAccelerationNoise);
      sensor.noise_corner = known_or(machine.sensors.acceleration_noise_corner, kAccelerationCorner);
      break;
    case Unit::radian_per_second: sensor.noise_floor = motor_speed_noise(machine, scales); break;
    case Unit::radian: sensor.noise_floor = counts ? 0.0 : known_or(machine.sensors.slew_angle_noise, kAngleNoise); break;
    default: break;
  }
  return sensor;
}

std::vector<Sensor> sensors_of(const CraneParameters& machine, const Scales& scales) {
  std::vector<Sensor> sensors;
  const int groups = machine.drive.group_count;
  for (int group = 0; group < groups; ++group) {
    for (const msgs::Signal& signal : msgs::kSignals) {
      Sensor sensor = sensor_of(signal, machine, scales);
      if (sensor.place != SensorPlace::motor_group) continue;
      sensor.name = of_group(sensor.name, group, groups);
      sensor.group = group;
      sensors.push_back(std::move(sensor));
    }
  }
  for (const msgs::Signal& signal : msgs::kSignals) {
    const SensorPlace place = place_named(signal.place);
    if (place != SensorPlace::motor_group && has_place(machine, place)) sensors.push_back(sensor_of(signal, machine, scales));
  }
  return sensors;
}

// Units of an axis and of its motor's shaft.
struct AxisUnits {
  Unit inertia, torque, position, speed, stiffness;
};
constexpr AxisUnits kRotary{Unit::kilogram_square_metre, Unit::newton_metre, Unit::radian, Unit::radian_per_second, Unit::newton_metre_per_radian};
constexpr AxisUnits kLinear{Unit::kilogram, Unit::newton, Unit::metre, Unit::metre_per_second, Unit::newton_per_metre};

std::vector<Effort> efforts_of_axis(const AxisForm& form, const Scales& scales) {
  const AxisUnits& shaft = form.is_shaft_linear ? kLinear : kRotary;
  const AxisUnits& axis = form.is_linear ? kLinear : kRotary;
  return {{form.is_shaft_linear ? "motor force" : "motor torque", shaft.torque, EffortPlace::motor_group, 0, scales.motor_torque},
          {form.is_linear ? "force on the axis" : "torque on the axis", axis.torque, EffortPlace::axis, -1, scales.axis_torque}};
}

std::vector<Sensor> sensors_of_axis(const AxisForm& form, const CraneParameters& machine, const Scales& scales) {
  const AxisUnits& shaft = form.is_shaft_linear ? kLinear : kRotary;
  std::vector<Sensor> sensors{
      {"motor speed", shaft.speed, "ENCODER", "shaft_speed", SensorPlace::motor_group, 0, 0.0, motor_speed_noise(machine, scales)},
      {"motor position", shaft.position, "ENCODER", "shaft_position", SensorPlace::motor_group, 0, 0.0, 0.0}};
  if (machine.house.has_encoder) {
    sensors.push_back({"load position", form.is_linear ? Unit::metre : Unit::radian, "SENSORS", "slew_angle", SensorPlace::axis, -1, 0.0,
                       known_or(machine.sensors.slew_angle_noise, form.is_linear ? kScaleNoise : kAngleNoise)});
  }
  return sensors;
}

// All that an axis may have.
std::vector<Parameter> all_parameters_of_axis(const AxisForm& form) {
  using C = CraneParameters;
  const AxisUnits& shaft = form.is_shaft_linear ? kLinear : kRotary;
  const AxisUnits& axis = form.is_linear ? kLinear : kRotary;
  return {
      {form.is_linear ? "mass" : "inertia", kUnitDeviation,
       {{"", form.is_linear ? "mass" : "inertia", axis.inertia, [](C& c) -> double& { return c.house.inertia; }}}},
      {form.is_shaft_linear ? "motor mass" : "motor inertia", kUnitDeviation,
       {{"", form.is_shaft_linear ? "motor_mass" : "motor_inertia", shaft.inertia, [](C& c) -> double& { return c.drive.motor_inertia; }}}},
      {"transmission stiffness", kUnitDeviation,
       {{"transmission", "stiffness", axis.stiffness, [](C& c) -> double& { return c.drive.gearbox_stiffness; }}}},
      {"transmission damping", kDampingDeviation,
       {{"transmission", "damping_ratio", Unit::none, [](C& c) -> double& { return c.drive.gear_damping_ratio; }}}},
      {"play", kUnitDeviation, {{"transmission", "play", axis.position, [](C& c) -> double& { return c.drive.gearbox_play; }}}},
      {"constant load", kUnitDeviation, {{"load", "constant", axis.torque, [](C& c) -> double& { return c.axis_force.constant; }}}},
      {"gravity load", kUnitDeviation, {{"load", "gravity", axis.torque, [](C& c) -> double& { return c.axis_force.gravity; }}}},
  };
}

// The file's own spread, where it gives one: of several numbers that are wrong together, the largest.
void take_spreads(const std::map<std::string, double>& spreads, std::vector<Parameter>& parameters) {
  for (Parameter& parameter : parameters) {
    double largest = 0.0;
    for (const FileNumber& number : parameter.numbers) {
      const std::string key = (number.section.empty() ? "" : std::string(number.section) + ".") + std::string(number.key);
      const auto found = spreads.find(key);
      if (found != spreads.end()) largest = std::max(largest, found->second);
    }
    if (largest > 0.0) parameter.spread = largest;
  }
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
      {"gear damping", kDampingDeviation,
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
      {"boom damping", kDampingDeviation, {{"boom", "damping_ratio", Unit::none, [](C& c) -> double& { return c.boom.damping_ratio; }}}},
      {"boom angle", kUnitDeviation, {{"boom", "angle", Unit::radian, [](C& c) -> double& { return c.boom.angle; }}}},
      {"pivot radius", kUnitDeviation, {{"boom", "pivot_radius", Unit::metre, [](C& c) -> double& { return c.boom.pivot_radius; }}}},
      {"load mass", kUnitDeviation, {{"load", "mass", Unit::kilogram, [](C& c) -> double& { return c.load.mass; }}}},
      {"rope length", kUnitDeviation, {{"load", "rope_length", Unit::metre, [](C& c) -> double& { return c.load.rope_length; }}}},
      {"rod length", kUnitDeviation, {{"load", "rod_length", Unit::metre, [](C& c) -> double& { return c.load.rod_length; }}}},
      {"load damping", kDampingDeviation, {{"load", "damping_ratio", Unit::none, [](C& c) -> double& { return c.load.damping_ratio; }}}},
  };
}

std::vector<Parameter> parameters_of(const MachineFile& file) {
  CraneParameters machine = file.parameters;
  std::vector<Parameter> parameters = file.kind == MachineKind::axis ? all_parameters_of_axis(file.axis) : all_parameters();
  std::erase_if(parameters, [&](const Parameter& parameter) {
    const bool has_any = std::any_of(parameter.numbers.begin(), parameter.numbers.end(),
                                     [&](const FileNumber& number) { return number.of(machine) != 0.0; });
    const bool is_of_load = file.kind == MachineKind::crane && parameter.numbers.front().section == "load";
    return !has_any || (is_of_load && machine.load.mass == 0.0);
  });
  take_spreads(file.spreads, parameters);
  return parameters;
}

}  // namespace

std::vector<AccelerometerGain> accelerometer_gains() {
  using C = CraneParameters;
  return {
      {SensorPlace::pivot, {"pivot accelerometer gain", kAccelerometerDeviation, {{"sensors", "pivot_gain", Unit::none, [](C& c) -> double& { return c.sensors.pivot_gain; }}}}},
      {SensorPlace::middle, {"middle accelerometer gain", kAccelerometerDeviation, {{"sensors", "middle_gain", Unit::none, [](C& c) -> double& { return c.sensors.middle_gain; }}}}},
      {SensorPlace::tip, {"tip accelerometer gain", kAccelerometerDeviation, {{"sensors", "tip_gain", Unit::none, [](C& c) -> double& { return c.sensors.tip_gain; }}}}},
  };
}

SensorPlace place_named(std::string_view name) {
  const auto found = std::find(kPlaces.begin(), kPlaces.end(), name);
  if (found == kPlaces.end()) throw std::invalid_argument("no place of a sensor is called '" + std::string(name) + "'");
  return static_cast<SensorPlace>(found - kPlaces.begin());
}

bool has_place(const CraneParameters& machine, SensorPlace place) {
  switch (place) {
    case SensorPlace::motor_group: return machine.drive.group_count > 0;
    case SensorPlace::axis: return machine.house.has_encoder;
    case SensorPlace::house: return machine.house.sensor_radius > 0.0;
    default: return machine.boom.length > 0.0;
  }
}

MachineDescription describe(const MachineFile& file) {
  MachineDescription description;
  description.kind = name_of(file.kind);
  description.machine = file.parameters;
  description.scales = scales_of(file.parameters);
  const bool is_axis = file.kind == MachineKind::axis;
  description.efforts = is_axis ? efforts_of_axis(file.axis, description.scales) : efforts_of(file.parameters, description.scales);
  description.sensors = is_axis ? sensors_of_axis(file.axis, file.parameters, description.scales) : sensors_of(file.parameters, description.scales);
  description.parameters = parameters_of(file);
  return description;
}

MachineDescription describe(const CraneParameters& machine) {
  MachineFile file;
  file.parameters = machine;
  return describe(file);
}

}  // namespace slewlab::sim
