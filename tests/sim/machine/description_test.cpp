#include "sim/machine/description.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/sim/thesis_crane.h"

namespace slewlab::sim {
namespace {

MachineDescription thesis() {
  return describe(load_machine_file(std::string(SLEWLAB_SOURCE_DIR) + "/config/cranes/thesis.yaml"));
}

bool has_sensor(const MachineDescription& description, std::string_view name) {
  return std::any_of(description.sensors.begin(), description.sensors.end(), [&](const Sensor& sensor) { return sensor.name == name; });
}

TEST(Description, NamesWhatPushesAndWhatIsMeasured) {
  const MachineDescription description = thesis();
  EXPECT_EQ(description.kind, "crane");
  ASSERT_GE(description.efforts.size(), 5u);
  EXPECT_EQ(description.efforts[0].name, "motor torque of group 1");
  EXPECT_EQ(description.efforts[0].full, 250.0);  // T100, config/cranes/thesis.yaml
  EXPECT_EQ(description.sensors.size(), 2u * 2u + 4u + 1u);
  const auto tip = std::find_if(description.sensors.begin(), description.sensors.end(), [](const Sensor& sensor) { return sensor.name == "tip acceleration"; });
  ASSERT_NE(tip, description.sensors.end());
  EXPECT_EQ(tip->channel, "SENSORS");
  EXPECT_NEAR(tip->radius, description.scales.reach, 1e-12);
}

TEST(Description, ParametersStandWhereTheFileHasThem) {
  MachineDescription description = thesis();
  EXPECT_EQ(description.parameters.size(), 16u);
  for (const Parameter& parameter : description.parameters) {
    for (const FileNumber& number : parameter.numbers) EXPECT_GT(number.of(description.machine), 0.0) << number.key;
  }
}

TEST(Description, AMachineHasOnlyWhatItHas) {
  MachineFile file = load_machine_file(std::string(SLEWLAB_SOURCE_DIR) + "/config/cranes/no_load.yaml");
  file.parameters.drive.gearbox_play = file.parameters.drive.pinion_play = 0.0;
  const MachineDescription description = describe(file);
  for (const Parameter& parameter : description.parameters) {
    EXPECT_NE(parameter.numbers.front().section, "load");
    EXPECT_NE(parameter.name, "play");
  }
  file.parameters.boom = {};
  file.parameters.boom.element_count = 0;
  const MachineDescription without_boom = describe(file);
  EXPECT_FALSE(has_sensor(without_boom, "tip acceleration"));
  EXPECT_TRUE(has_sensor(without_boom, "house acceleration"));
}

}  // namespace
}  // namespace slewlab::sim
