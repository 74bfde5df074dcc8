#include "sim/machine/sensors_file.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "sim/machine/description.h"
#include "tests/sim/machine/written_machine.h"

namespace slewlab::sim {
namespace {

const std::string kThesisCrane = "include: " SLEWLAB_SOURCE_DIR "/config/cranes/thesis.yaml\n";
const std::string kLinearAxis = R"(kind: axis
coordinate: {value: linear, source: test}
mass: {value: 95, unit: kg, source: test}
travel_per_turn: {value: 10, unit: mm, source: test}
load_encoder: {value: true, source: test}
rated_torque: {value: 0.6, unit: N m, source: test}
top_speed: {value: 0.3, unit: m/s, source: test}
)";

MachineDescription described_as(const std::string& text) { return describe(load_written(text)); }

Sensor sensor_of(const MachineDescription& machine, std::string_view name) {
  const auto found = std::find_if(machine.sensors.begin(), machine.sensors.end(), [&](const Sensor& each) { return each.name == name; });
  return found == machine.sensors.end() ? Sensor{} : *found;
}

TEST(SensorsFile, NoiseOfTheFileTakesTheOrdinaryOnesPlace) {
  const MachineDescription crane = described_as(kThesisCrane + R"(sensors:
  motor_speed_noise: {value: 3, unit: deg/s, source: test}
  acceleration_noise: {value: 0.02, unit: m/s^2, source: test}
  acceleration_noise_corner: {value: 4, unit: Hz, source: test}
)");
  EXPECT_NEAR(sensor_of(crane, "shaft speed of group 2").noise_floor, 0.0523599, 1e-6);  // 3 deg/s in rad/s
  for (const char* place : {"house", "pivot", "middle", "tip"}) {
    EXPECT_EQ(sensor_of(crane, std::string(place) + " acceleration").noise_floor, 0.02);
    EXPECT_EQ(sensor_of(crane, std::string(place) + " acceleration").noise_corner, 4.0);
  }
  EXPECT_EQ(sensor_of(crane, "slew angle").noise_floor, sensor_of(described_as(kThesisCrane), "slew angle").noise_floor);

  const MachineDescription axis = described_as(kLinearAxis + R"(sensors:
  motor_speed_noise: {value: 0.5, unit: rad/s, source: test}
  load_position_noise: {value: 0.01, unit: mm, source: test}
)");
  EXPECT_EQ(sensor_of(axis, "motor speed").noise_floor, 0.5);
  EXPECT_DOUBLE_EQ(sensor_of(axis, "load position").noise_floor, 1e-5);
}

TEST(SensorsFile, OrdinarySpeedNoiseIsAShareOfTheMotorsTopSpeed) {
  // 0.05 rad/s by 215.4 * 12.7 (config/cranes/thesis.yaml) is 136.8 rad/s at the motor, of which a drive reports 0.02 rad/s.
  EXPECT_NEAR(sensor_of(described_as(kThesisCrane), "shaft speed of group 1").noise_floor, 0.02, 0.001);
  const MachineDescription twice = described_as(kThesisCrane + "drive:\n  top_speed: {value: 0.1, unit: rad/s, source: test}\n");
  EXPECT_DOUBLE_EQ(sensor_of(twice, "shaft speed of group 1").noise_floor, 2.0 * sensor_of(described_as(kThesisCrane), "shaft speed of group 1").noise_floor);
}

TEST(SensorsFile, GainsOfAccelerometersAreOneWhereTheFileHasNone) {
  const SensorParameters without = described_as(kThesisCrane).machine.sensors;
  EXPECT_EQ(without.pivot_gain, 1.0);
  EXPECT_EQ(without.middle_gain, 1.0);
  EXPECT_EQ(without.tip_gain, 1.0);
  const SensorParameters with = described_as(kThesisCrane + "sensors:\n  middle_gain: {value: 98, unit: \"%\", source: test}\n  tip_gain: {value: 1.04, unit: \"-\", source: test}\n").machine.sensors;
  EXPECT_EQ(with.pivot_gain, 1.0);
  EXPECT_DOUBLE_EQ(with.middle_gain, 0.98);
  EXPECT_EQ(with.tip_gain, 1.04);
  EXPECT_NE(complaint_about(kThesisCrane + "sensors:\n  tip_gain: {value: -1, unit: \"-\", source: test}\n").find("tip_gain"), std::string::npos);
}

TEST(SensorsFile, WhatAMachineDoesNotHaveIsRefused) {
  EXPECT_NE(complaint_about(kThesisCrane + "sensors:\n  acceleration_noise: {value: 0.02, unit: g, source: test}\n").find("sensors.acceleration_noise"), std::string::npos);
  EXPECT_NE(complaint_about(kThesisCrane + "sensors:\n  acceleration_noise: {value: 0, unit: m/s^2, source: test}\n").find("acceleration_noise': found 0 m"), std::string::npos);
  EXPECT_NE(complaint_about(kLinearAxis + "sensors:\n  acceleration_noise: {value: 0.02, unit: m/s^2, source: test}\n").find("load_position_noise"), std::string::npos);
}

}  // namespace
}  // namespace slewlab::sim
