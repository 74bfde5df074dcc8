// The table of signals that the build makes of the .lcm files, against what a machine's description says of its sensors.
#include <gtest/gtest.h>

#include <map>
#include <slewlab_msgs/fields.hpp>
#include <slewlab_msgs/signals.hpp>
#include <string>
#include <utility>

#include "msgs/messages.h"
#include "sim/machine/description.h"
#include "sim/machine/machine_file.h"

namespace slewlab::msgs {
namespace {

// Unit by field.
template <class Message>
std::map<std::string, std::string> units() {
  std::map<std::string, std::string> found;
  visit_fields(Message{}, [&](const char* name, const char* unit, const auto&) { found[name] = unit; });
  return found;
}

TEST(Signals, FieldsHaveTheUnitsOfTheirComments) {
  const auto encoder = units<Encoder>();
  EXPECT_EQ(encoder.size(), 8u);
  EXPECT_EQ(encoder.at("sequence"), "-");
  EXPECT_EQ(encoder.at("simulated_time"), "ns");
  EXPECT_EQ(encoder.at("shaft_speed"), "rad/s");
  EXPECT_EQ(units<Torque>().at("motor_torque"), "Nm");
  EXPECT_EQ(units<Truth>().at("shear_force"), "N");
  EXPECT_EQ(units<PlantStatus>().at("bin_edge"), "s");
  EXPECT_EQ(units<Operator>().at("speed_request"), "-");
}

TEST(Signals, ValuesAreTheMessages) {
  Torque torque{};
  torque.group_count = 2;
  torque.motor_torque = {3.0, -4.0};
  std::vector<double> found;
  visit_fields(torque, [&](const char* name, const char*, const auto& value) {
    if constexpr (std::is_same_v<std::decay_t<decltype(value)>, std::vector<double>>) {
      if (std::string(name) == "motor_torque") found = value;
    }
  });
  EXPECT_EQ(found, torque.motor_torque);
}

TEST(Signals, TheSensorsOfACraneAreFieldsOfTheWireInTheirUnits) {
  const auto encoder = units<Encoder>(), sensors = units<Sensors>();
  const sim::MachineDescription crane = sim::describe(sim::load_machine_file(SLEWLAB_SOURCE_DIR "/config/cranes/thesis.yaml"));
  ASSERT_GE(crane.sensors.size(), 9u);
  for (const sim::Sensor& sensor : crane.sensors) {
    ASSERT_TRUE(sensor.channel == std::string(kEncoderChannel) || sensor.channel == std::string(kSensorsChannel)) << sensor.name;
    const auto& fields = sensor.channel == std::string(kEncoderChannel) ? encoder : sensors;
    const auto field = fields.find(std::string(sensor.field));
    ASSERT_NE(field, fields.end()) << sensor.name << ": " << sensor.channel << " has no field " << sensor.field;
    EXPECT_EQ(field->second, common::name_of(sensor.unit)) << sensor.name;
  }
}

TEST(Signals, TheNumbersOfSensorsAreTheMessagesOwn) {
  // 4 numbers are every message's head.
  ASSERT_EQ(kSensorFields<Sensors>.size(), units<Sensors>().size() - 4);
  Sensors message{};
  double next = 1.0;
  for (const auto& field : kSensorFields<Sensors>) message.*field.value = next++;
  std::size_t k = 0;
  visit_fields(message, [&](const char* name, const char* unit, const auto& value) {
    if constexpr (std::is_same_v<std::decay_t<decltype(value)>, double>) {
      ASSERT_LT(k, kSensorFields<Sensors>.size());
      EXPECT_EQ(kSensorFields<Sensors>[k].field, name);
      EXPECT_EQ(kSensorFields<Sensors>[k].unit, unit);
      EXPECT_EQ(value, static_cast<double>(k + 1)) << name;
      ++k;
    }
  });
  EXPECT_EQ(k, kSensorFields<Sensors>.size());
}

TEST(Signals, APlaceOfTheTableIsOneOfTheDescription) {
  for (const Signal& signal : kSignals) EXPECT_NO_THROW(sim::place_named(signal.place)) << signal.field;
  EXPECT_THROW(sim::place_named("nowhere"), std::invalid_argument);
}

}  // namespace
}  // namespace slewlab::msgs
