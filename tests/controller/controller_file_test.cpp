#include "controller/controller_file.h"

#include <gtest/gtest.h>

#include <string>

namespace slewlab::controller {
namespace {

const std::string kFolder = SLEWLAB_SOURCE_DIR "/config/controllers/";

std::string complaint(const std::vector<common::Override>& overrides, const std::string& name = "thesis.yaml") {
  try {
    load_controller_file(kFolder + name, overrides);
  } catch (const common::InputError& error) {
    return error.what();
  }
  return "";
}

TEST(ControllerFile, ThesisValues) {
  const ControllerSettings settings = load_controller_file(kFolder + "thesis.yaml").settings;
  EXPECT_EQ(settings.group_count, 2);
  EXPECT_NEAR(settings.total_ratio, 215.4 * 12.7, 1e-9);  // thesis 2.10
  EXPECT_EQ(settings.ramp.shape, RampShape::s_curve);
  EXPECT_EQ(settings.ramp.acceleration_time, 9.4 - 5.0);  // thesis 3.5
  EXPECT_TRUE(settings.play_compensation.enabled);
  EXPECT_EQ(settings.speed_control.droop, 0.0);
  // Table 4.2: 0.0156 rad/s^2 accelerating, 0.0336 rad/s^2 braking; within 5 %, the thesis's tolerance.
  const RampSettings& ramp = settings.ramp;
  EXPECT_NEAR(ramp.top_speed / (ramp.acceleration_time * (1.0 - ramp.curved_share)), 0.0156, 0.05 * 0.0156);
  EXPECT_NEAR(ramp.top_speed / ramp.emergency_stop_time, 0.0336, 0.05 * 0.0336);
}

// What a file leaves out follows from top speed and emergency stop.
TEST(ControllerFile, PlausibilityFollowsFromTheRampWhereItIsNotGiven) {
  const double top_speed = 0.05 * 2735.58;  // [rad/s] of the motors
  const PlausibilitySettings given = load_controller_file(kFolder + "thesis.yaml").settings.plausibility;
  EXPECT_DOUBLE_EQ(given.speed_limit, 1.3 * top_speed);
  EXPECT_EQ(given.acceleration_limit, 800.0);
  EXPECT_DOUBLE_EQ(given.tolerance, 0.03 * top_speed);
  EXPECT_DOUBLE_EQ(given.timeout, 0.05);
  const PlausibilitySettings none =
      load_controller_file(kFolder + "thesis.yaml", {{"plausibility", "null"}}).settings.plausibility;
  EXPECT_DOUBLE_EQ(none.speed_limit, 1.5 * top_speed);
  EXPECT_DOUBLE_EQ(none.acceleration_limit, 20.0 * top_speed / 1.5);
  EXPECT_DOUBLE_EQ(none.tolerance, 0.05 * top_speed);
  EXPECT_DOUBLE_EQ(none.timeout, 0.05);
  EXPECT_NE(complaint({{"plausibility.speed_limit", "100 %"}}).find("expected a number above"), std::string::npos);
}

TEST(ControllerFile, VariantsChangeWhatTheySay) {
  const ControllerFile thesis = load_controller_file(kFolder + "thesis.yaml");
  const ControllerFile without = load_controller_file(kFolder + "thesis_without_play_compensation.yaml");
  EXPECT_FALSE(without.settings.play_compensation.enabled);
  EXPECT_EQ(without.settings.ramp.acceleration_time, thesis.settings.ramp.acceleration_time);
  EXPECT_NE(without.canonical_text, thesis.canonical_text);
  const ControllerSettings linear = load_controller_file(kFolder + "thesis_linear_ramp.yaml").settings;
  EXPECT_EQ(linear.ramp.shape, RampShape::linear);
  // The same largest acceleration as the S-curve's.
  EXPECT_NEAR(linear.ramp.top_speed / linear.ramp.acceleration_time, 0.05 / (4.4 * 0.7), 1e-6);
}

TEST(ControllerFile, OverridesFromTheCommandLine) {
  const ControllerFile file =
      load_controller_file(kFolder + "thesis.yaml", {{"ramp.curved_share", "0.2"}, {"speed_control.droop", "2"}});
  EXPECT_EQ(file.settings.ramp.curved_share, 0.2);
  EXPECT_EQ(file.settings.speed_control.droop, 2.0);
}

TEST(ControllerFile, BadValuesAreExplained) {
  EXPECT_EQ(complaint({{"ramp.curved_share", "0.6"}}),
            "--set ramp.curved_share=0.6: key 'ramp.curved_share': found 0.6, expected a number from 0 to 0.5");
  EXPECT_EQ(complaint({{"ramp.shape", "round"}}),
            "--set ramp.shape=round: key 'ramp.shape': found round, expected s_curve or linear");
  EXPECT_EQ(complaint({{"motor_torque_rated", "-400"}}),
            "--set motor_torque_rated=-400: key 'motor_torque_rated': found -400 N m, expected a number above 0 N m");
  EXPECT_NE(complaint({{"ramp.top_sped", "1"}}).find("expected 'top_speed' (or one of"), std::string::npos);
}

TEST(ControllerFile, PlayMapMustJoinItsMirrorImageAndRise) {
  EXPECT_NE(complaint({{"play_compensation.half_2", "{value: [-5, -10, -10, 3, 24, 100], unit: '%'}"}})
                .find("expected -0.1 first, the opposite of 'half_1'"),
            std::string::npos);
  EXPECT_NE(complaint({{"play_compensation.average", "{value: [0, 18, 18, 48, 57, 100], unit: '%'}"}}).find("expected numbers that rise"),
            std::string::npos);
  EXPECT_NE(complaint({{"play_compensation.half_1", "{value: [10, 46], unit: '%'}"}}).find("as many numbers as 'average' has: 6"),
            std::string::npos);
}

TEST(ControllerFile, AnotherKindOfFileIsRefused) {
  const std::string said = complaint({{"kind", "crane"}, {"ramp", "null"}});
  EXPECT_NE(said.find("key 'kind': found crane, expected controller"), std::string::npos);
  EXPECT_EQ(said.find("ramp"), std::string::npos) << "what a file of another kind lacks is of no interest";
  EXPECT_NE(complaint({{"kind", "contoller"}, {"ramp", "null"}}).find("key 'ramp'"), std::string::npos) << "a slip of the pen";
}

TEST(ControllerFile, SwitchesOfThePlayCompensationAreTimesThatDoNotFall) {
  const auto switches = [](const std::string& second) {
    return std::vector<common::Override>{
        {"play_compensation.switches", "[{time: {value: 12.5, unit: s, source: test}, enabled: {value: false, source: test}}, "
                                       "{time: {value: " + second + ", unit: s, source: test}, enabled: {value: true, source: test}}]"}};
  };
  const std::vector<PlaySwitch> read = load_controller_file(kFolder + "thesis.yaml", switches("12.51")).settings.play_compensation.switches;
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[0].time, 12'500'000'000);
  EXPECT_FALSE(read[0].enabled);
  EXPECT_EQ(read[1].time, 12'510'000'000);
  EXPECT_TRUE(read[1].enabled);
  EXPECT_NE(complaint(switches("12")).find("found 12 s, expected no time before that of the switch before, 12.5 s"), std::string::npos)
      << complaint(switches("12"));
}

}  // namespace
}  // namespace slewlab::controller
