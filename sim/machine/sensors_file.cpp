#include "sim/machine/sensors_file.h"

#include "common/unit.h"

namespace slewlab::sim {
namespace {

using common::positive;
using common::Unit;
using common::YamlReader;

double number_or_ordinary(YamlReader& reader, std::string_view key, Unit unit) { return reader.optional_number(key, unit, positive()).value_or(0.0); }
double gain_or_one(YamlReader& reader, std::string_view key) { return reader.optional_number(key, Unit::none, positive()).value_or(1.0); }

}  // namespace

SensorParameters read_crane_sensors(YamlReader reader) {
  SensorParameters sensors;
  sensors.motor_speed_noise = number_or_ordinary(reader, "motor_speed_noise", Unit::radian_per_second);
  sensors.slew_angle_noise = number_or_ordinary(reader, "slew_angle_noise", Unit::radian);
  sensors.acceleration_noise = number_or_ordinary(reader, "acceleration_noise", Unit::metre_per_second_squared);
  sensors.acceleration_noise_corner = number_or_ordinary(reader, "acceleration_noise_corner", Unit::hertz);
  sensors.pivot_gain = gain_or_one(reader, "pivot_gain");
  sensors.middle_gain = gain_or_one(reader, "middle_gain");
  sensors.tip_gain = gain_or_one(reader, "tip_gain");
  reader.finish();
  return sensors;
}

SensorParameters read_axis_sensors(YamlReader reader, bool is_linear, bool is_shaft_linear) {
  SensorParameters sensors;
  sensors.motor_speed_noise = number_or_ordinary(reader, "motor_speed_noise", is_shaft_linear ? Unit::metre_per_second : Unit::radian_per_second);
  sensors.slew_angle_noise = number_or_ordinary(reader, "load_position_noise", is_linear ? Unit::metre : Unit::radian);
  reader.finish();
  return sensors;
}

}  // namespace slewlab::sim
