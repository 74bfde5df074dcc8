#include "sim/machine/axis_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "sim/analysis/eigen.h"
#include "sim/machine/description.h"
#include "tests/sim/machine/written_machine.h"

namespace slewlab::sim {
namespace {

const std::string kRotary = R"(kind: axis
coordinate: {value: rotary, source: test}
inertia: {value: 12, unit: kg m^2, spread: 10 %, source: test}
motor_inertia: {value: 0.002, unit: kg m^2, source: test}
ratio: {value: 50, unit: "-", source: test}
transmission:
  stiffness: {value: 200, unit: kN m/rad, source: test}
  damping_ratio: {value: 5, unit: "%", source: test}
  play: {value: 1, unit: mrad, source: test}
load:
  constant: {value: -20, unit: N m, source: test}
  gravity: {value: 100, unit: N m, source: test}
  gravity_angle: {value: 90, unit: deg, source: test}
load_encoder: {value: true, source: test}
rated_torque: {value: 8, unit: N m, source: test}
top_speed: {value: 2, unit: rad/s, source: test}
)";

const std::string kLinear = R"(kind: axis
coordinate: {value: linear, source: test}
mass: {value: 95, unit: kg, source: test}
rated_force: {value: 500, unit: N, source: test}
top_speed: {value: 0.3, unit: m/s, source: test}
)";

const Parameter* find(const MachineDescription& description, std::string_view name) {
  const auto found = std::find_if(description.parameters.begin(), description.parameters.end(), [&](const Parameter& p) { return p.name == name; });
  return found == description.parameters.end() ? nullptr : &*found;
}

TEST(AxisFile, ARotaryAxisIsReadInItsUnits) {
  const MachineFile file = load_written(kRotary);
  EXPECT_EQ(file.kind, MachineKind::axis);
  EXPECT_FALSE(file.axis.is_linear);
  EXPECT_TRUE(file.parameters.house.has_encoder);
  EXPECT_EQ(file.parameters.house.inertia, 12.0);
  EXPECT_EQ(file.parameters.drive.group_count, 1);
  EXPECT_FALSE(file.parameters.drive.is_rigid);
  EXPECT_DOUBLE_EQ(file.parameters.drive.gearbox_stiffness, 2e5);
  EXPECT_DOUBLE_EQ(file.parameters.axis_force.gravity_angle, 0.5 * std::numbers::pi);
  EXPECT_EQ(file.parameters.axis_force.constant, -20.0);
}

TEST(AxisFile, DescriptionSpeaksOfTheAxisAndOfNothingElse) {
  const MachineDescription description = describe(load_written(kRotary));
  EXPECT_EQ(description.kind, "axis");
  for (const Sensor& sensor : description.sensors) {
    for (const char* word : {"house", "slew", "boom", "tip"}) EXPECT_EQ(sensor.name.find(word), std::string::npos) << sensor.name;
  }
  ASSERT_EQ(description.sensors.size(), 3u);
  EXPECT_EQ(description.sensors[2].name, "load position");
  // 8 Nm * 50, and 12 kg m^2 + 0.002 kg m^2 * 50^2.
  EXPECT_DOUBLE_EQ(description.scales.axis_torque, 400.0);
  EXPECT_DOUBLE_EQ(description.scales.axis_inertia, 17.0);
  ASSERT_NE(find(description, "inertia"), nullptr);
  EXPECT_DOUBLE_EQ(find(description, "inertia")->spread, 0.1);
  EXPECT_DOUBLE_EQ(find(description, "play")->spread, kUnitDeviation);
  EXPECT_NE(find(description, "gravity load"), nullptr);
}

TEST(AxisFile, ALinearAxisWithoutAMotorThatTurnsIsInMetresAndNewtons) {
  const MachineFile file = load_written(kLinear);
  EXPECT_TRUE(file.parameters.drive.is_rigid);
  const MachineDescription description = describe(file);
  ASSERT_EQ(description.sensors.size(), 2u);
  EXPECT_EQ(description.sensors[0].unit, common::Unit::metre_per_second);
  EXPECT_EQ(description.efforts[0].name, "motor force");
  EXPECT_EQ(description.efforts[0].unit, common::Unit::newton);
  EXPECT_EQ(description.scales.axis_torque, 500.0);
  EXPECT_EQ(find(description, "transmission stiffness"), nullptr);
  EXPECT_EQ(find(description, "mass")->numbers.front().unit, common::Unit::kilogram);
}

TEST(AxisFile, TravelPerTurnIsTheRatioOfALinearAxis) {
  std::string text = kLinear;
  text.replace(text.find("rated_force: {value: 500, unit: N"), 33, "travel_per_turn: {value: 10, unit: mm, source: test}\nrated_torque: {value: 2, unit: N m");
  const MachineDescription description = describe(load_written(text));
  EXPECT_NEAR(description.scales.ratio, 2.0 * std::numbers::pi / 0.01, 1e-9);  // [rad/m]
  EXPECT_EQ(description.efforts[0].unit, common::Unit::newton_metre);
}

TEST(AxisFile, OneInertiaHasNoModeThatSwings) {
  const MachineFile file = load_written(kLinear);
  EXPECT_TRUE(structural_modes(file.parameters, 5).empty());
  const std::vector<Mode> modes = crane_modes(file.parameters);
  ASSERT_EQ(modes.size(), 1u);
  EXPECT_EQ(modes[0].kind, ModeKind::kRigid);
}

// Two inertias on a spring: sqrt(k (1/J1 + 1/J2)) / 2 pi.
TEST(AxisFile, AnElasticAxisHasTheModeOfTwoInertias) {
  const std::vector<double> modes = structural_modes(load_written(kRotary).parameters, 5);
  ASSERT_EQ(modes.size(), 1u);
  EXPECT_NEAR(modes[0], std::sqrt(2e5 * (1.0 / 5.0 + 1.0 / 12.0)) / (2.0 * std::numbers::pi), 1e-6 * modes[0]);
}

TEST(AxisFile, WhatDoesNotFitIsExplained) {
  std::string text = kLinear;
  EXPECT_NE(complaint_about(text + "inertia: {value: 1, unit: kg m^2, source: test}\n").find("'mass' in kg: the axis is linear"), std::string::npos);
  EXPECT_NE(complaint_about(text + "house: {}\n").find("house"), std::string::npos);
  EXPECT_NE(complaint_about(text + "load: {gravity: {value: 1, unit: N m, source: test}}\n").find("load.constant in N"), std::string::npos);
  EXPECT_NE(complaint_about(text + "transmission:\n  stiffness: {value: 1, unit: kN/m, source: test}\n  damping_ratio: {value: 1, unit: \"%\", source: test}\n").find("'motor_mass'"), std::string::npos);
  EXPECT_NE(complaint_about("kind: lift\n").find("crane or axis"), std::string::npos);
  std::string spread = kLinear;
  spread.replace(spread.find("unit: kg,"), 9, "unit: kg, spread: wide,");
  EXPECT_NE(complaint_about(spread).find("such as 10 %"), std::string::npos);
  EXPECT_EQ(complaint_about(kLinear), "");
}

TEST(AxisFile, WhatNoAxisHasIsRefused) {
  const struct {
    const char *from, *to, *key, *expected;
  } kSlips[] = {
      {"inertia: {value: 12,", "inertia: {value: 1e308,", "'inertia'", "from 1e-12 to 1e+15 kg m^2"},
      {"rated_torque: {value: 8,", "rated_torque: {value: 1e200,", "'rated_torque'", "from 1e-09 to 1e+12 N m"},
      {"top_speed: {value: 2,", "top_speed: {value: 1e200,", "'top_speed'", "from 1e-09 to 1e+06 rad/s"},
      {"gravity_angle: {value: 90,", "gravity_angle: {value: 1e30,", "'load.gravity_angle'", "360"},
      {"gravity: {value: 100,", "gravity: {value: -1e13,", "'load.gravity'", "or as much below 0"},
      {"constant: {value: -20,", "constant: {value: 1e13,", "'load.constant'", "from 1e-09 to 1e+12 N m"},
      {"stiffness: {value: 200,", "stiffness: {value: 1e30,", "'transmission.stiffness'", "which no machine has"},
      {"play: {value: 1,", "play: {value: 1e30,", "'transmission.play'", "rad"},
      {"ratio: {value: 50,", "ratio: {value: 1e9,", "'ratio'", "from 1e-04 to 1e+06"},
      {"motor_inertia: {value: 0.002,", "motor_inertia: {value: 1e20,", "'motor_inertia'", "which no machine has"}};
  for (const auto& slip : kSlips) {
    std::string text = kRotary;
    text.replace(text.find(slip.from), std::string(slip.from).size(), slip.to);
    const std::string found = complaint_about(text);
    EXPECT_NE(found.find(slip.key), std::string::npos) << slip.to << ": " << found;
    EXPECT_NE(found.find(slip.expected), std::string::npos) << slip.to << ": " << found;
    EXPECT_NE(found.find("axis.yaml:"), std::string::npos) << found;
  }
}

// Scale is no slip.
TEST(AxisFile, AnAxisOfAnySizeIsRead) {
  for (const char* inertia : {"1e-6", "1e6"}) {
    std::string text = kRotary;
    text.replace(text.find("inertia: {value: 12,"), 20, std::string("inertia: {value: ") + inertia + ',');
    EXPECT_EQ(complaint_about(text), "") << inertia;
  }
}

}  // namespace
}  // namespace slewlab::sim
