// What an effect adds to the accelerometers of SENSORS, whichever there are (msgs/sensors_t.lcm has the table), and their gains.
#pragma once

#include <string_view>

#include "sim/integrate/plant_ports.h"
#include "sim/model/crane_parameters.h"

namespace slewlab::sim {

// Adds acceleration(place) [m/s^2] to the reading of each accelerometer, `place` as the table names it.
template <class Acceleration>
void add_to_accelerometers(PlantReadings& readings, const Acceleration& acceleration) {
  for (const auto& sensor : msgs::kSensorFields<PlantReadings>) {
    if (sensor.unit == "m/s^2") readings.*sensor.value += acceleration(sensor.place);
  }
}

// What the accelerometers read of what moves them: nothing but their gains between.
inline void apply_gains(const SensorParameters& sensors, msgs::SensorReadings& readings) {
  readings.pivot_acceleration *= sensors.pivot_gain;
  readings.middle_acceleration *= sensors.middle_gain;
  readings.tip_acceleration *= sensors.tip_gain;
}

// Share of the boom's length, from pivot to tip, at which a place lies; 0 of the house.
constexpr double share_of_boom(std::string_view place) { return place == "middle" ? 0.5 : place == "tip" ? 1.0 : 0.0; }

}  // namespace slewlab::sim
