// What a machine is, once for everybody: read from its file, described in a typed form that plant, reference, drive,
// records, diagnosis, acceptance and export consume.
//
//   efforts     what pushes: unit, where it acts, the size that counts as full
//   sensors     what is measured: unit, channel and field of the wire, place, noise floor
//   parameters  numbers that differ from unit to unit: unit, value, spread, where in the file, how they are set
//   scales      from which every threshold of generic code derives (scales.h)
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/unit.h"
#include "common/yaml_file.h"
#include "sim/machine/machine_file.h"
#include "sim/machine/scales.h"
#include "sim/model/crane_parameters.h"

namespace slewlab::sim {

enum class EffortPlace { motor_group, axis, tip, boom, load };

struct Effort {
  std::string name;
  common::Unit unit = common::Unit::none;
  EffortPlace place = EffortPlace::axis;
  int group = -1;     // of motor_group, from 0
  double full = 0.0;  // rated torque, or what the rated torque is at that place [unit]
};

enum class SensorPlace { motor_group, axis, house, pivot, middle, tip };
// The place as msgs/*.lcm name it. Throws std::invalid_argument of any other name.
SensorPlace place_named(std::string_view name);
// Whether the machine has that place.
bool has_place(const CraneParameters& machine, SensorPlace place);

struct Sensor {
  std::string name;
  common::Unit unit = common::Unit::none;
  std::string_view channel;  // of the wire
  std::string_view field;    // of the message
  SensorPlace place = SensorPlace::axis;
  int group = -1;            // index in the field where it is an array, from 0
  double radius = 0.0;       // [m] from the axis, of an accelerometer
  double noise_floor = 0.0;  // [unit] standard deviation of an ordinary sensor of its kind; 0 where the record tells it
  double noise_corner = 0.0; // [Hz] below which the noise rises as 1/f; 0: white
};

// One number of the file, and how it is set before assembly.
struct FileNumber {
  std::string_view section, key;  // no section: at the top of the file
  common::Unit unit = common::Unit::none;
  double& (*of)(CraneParameters&) = nullptr;
};

// One or several numbers that are wrong together, by one factor.
struct Parameter {
  std::string_view name;
  double spread = 0.0;  // [-] one standard deviation of the factor, from unit to unit
  std::vector<FileNumber> numbers;
};

struct MachineDescription {
  std::string kind;  // "crane", "axis"
  CraneParameters machine;
  std::vector<Effort> efforts;
  std::vector<Sensor> sensors;
  std::vector<Parameter> parameters;
  Scales scales;
};

// Throws std::invalid_argument where the machine has no scales.
MachineDescription describe(const MachineFile& file);
// Of a crane that comes from no file.
MachineDescription describe(const CraneParameters& machine);

// What an accelerometer reads of what moves it: no parameter of the machine, and of the house's said by `house.sensor_radius`.
struct AccelerometerGain {
  SensorPlace place = SensorPlace::tip;
  Parameter parameter;
};
std::vector<AccelerometerGain> accelerometer_gains();

// 5 % either way with equal chance is a standard deviation of 5 % / sqrt(3): chosen, the spread between units of one
// make; a file may give a number's own (`spread`).
inline constexpr double kUnitSpread = 0.05;                                 // [-] half range
inline constexpr double kUnitDeviation = kUnitSpread / 1.7320508075688772;  // [-]
// Damping is measured at its best and mostly guessed: chosen, a standard deviation of a fifth.
inline constexpr double kDampingDeviation = 0.2;  // [-]
// 10 % either way: chosen, 5 % that data sheets allow the sensitivity of industrial accelerometers, and as much again where one is not screwed to the place, or not
// lying in the direction, that the description has.
inline constexpr double kAccelerometerDeviation = 0.1 / 1.7320508075688772;  // [-]

}  // namespace slewlab::sim
