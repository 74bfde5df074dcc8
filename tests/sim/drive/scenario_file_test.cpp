#include "sim/drive/scenario_file.h"

#include <gtest/gtest.h>

#include <string>

namespace slewlab::sim {
namespace {

const std::string kThesis = SLEWLAB_SOURCE_DIR "/config/scenarios/thesis_slew.yaml";

std::string complaint(const std::vector<common::Override>& overrides) {
  try {
    load_scenario_file(kThesis, overrides);
  } catch (const common::InputError& error) {
    return error.what();
  }
  return "";
}

TEST(ScenarioFile, ThesisManoeuvre) {
  const Scenario scenario = load_scenario_file(kThesis);
  EXPECT_EQ(scenario.duration, 60'000'000'000);
  EXPECT_EQ(scenario.plant_step, 1'000'000);
  EXPECT_EQ(scenario.controller_period, 10'000'000);
  ASSERT_EQ(scenario.moves.size(), 2u);
  EXPECT_EQ(scenario.moves[0].time, 5'000'000'000);  // thesis 3.5
  EXPECT_EQ(scenario.moves[0].speed_request, 1.0);
  EXPECT_FALSE(scenario.moves[0].emergency_stop);
  EXPECT_EQ(scenario.moves[1].time, 30'000'000'000);  // thesis 4.4
  EXPECT_TRUE(scenario.moves[1].emergency_stop);
  EXPECT_EQ(scenario.moves[1].speed_request, 1.0) << "what a move does not name stays";
  EXPECT_EQ(scenario.crane.parameters.load.mass, 30e3);
  EXPECT_TRUE(scenario.faults.empty());
}

TEST(ScenarioFile, OverridesReachTheFilesItNames) {
  const Scenario scenario = load_scenario_file(
      kThesis, {{"crane.load.mass", "20 t"}, {"controller.ramp.curved_share", "0.2"}, {"duration", "10"}});
  EXPECT_EQ(scenario.crane.parameters.load.mass, 20e3);
  EXPECT_EQ(scenario.duration, 10'000'000'000);
  ASSERT_EQ(scenario.controller_overrides.size(), 1u);
  EXPECT_EQ(scenario.controller_overrides[0].key, "ramp.curved_share");
}

// Beyond any limit is 4000 times what the machine's motors are rated for: 250 N m of the thesis's, 120 N m of the harbour crane's.
TEST(ScenarioFile, ATorqueBeyondAnyLimitGoesWithTheMachine) {
  const auto torque_on = [](const std::string& scenario) {
    return load_scenario_file(scenario, {{"faults", "[{fault: {value: message_corrupted, source: test}, from: {value: 6, unit: s, source: test}, "
                                                    "channel: {value: TORQUE, source: test}, probability: {value: 1, unit: '-', source: test}, "
                                                    "corruption: {value: torque_limit, source: test}}]"}}).faults.at(0).torque;
  };
  EXPECT_EQ(torque_on(kThesis), 1e6);
  EXPECT_EQ(torque_on(SLEWLAB_SOURCE_DIR "/config/scenarios/harbour_5t_slew.yaml"), 4.8e5);
}

TEST(ScenarioFile, SwitchesEffectsOfItsMachineAtControllerPeriods) {
  const auto with = [](const std::string& time, const std::string& effect) {
    return std::vector<common::Override>{
        {"crane.effects", "[{effect: dragging_brake, torque: {value: 5, unit: N m, source: test}, unevenness: {value: 0, unit: '-', source: test}, "
                          "give: {value: 0, unit: rad, source: test}}]"},
        {"effect_switches", "[{time: {value: " + time + ", unit: s, source: test}, effect: " + effect + ", on: {value: false, source: test}}]"}};
  };
  const Scenario scenario = load_scenario_file(kThesis, with("12.5", "dragging_brake"));
  ASSERT_EQ(scenario.effect_switches.size(), 1u);
  EXPECT_EQ(scenario.effect_switches[0].time, 12'500'000'000);
  EXPECT_EQ(scenario.effect_switches[0].effect, "dragging_brake");
  EXPECT_FALSE(scenario.effect_switches[0].on);
  EXPECT_NE(complaint(with("12.5", "gusts")).find("key 'effect_switches': found 'gusts', expected an effect that stands under 'effects'"), std::string::npos);
  EXPECT_NE(complaint(with("12.503", "dragging_brake")).find("found 12.503 s, expected a whole multiple of the controller period, 10 ms"), std::string::npos);
}

TEST(ScenarioFile, NamesAnotherCraneFromTheCommandLine) {
  const Scenario scenario =
      load_scenario_file(kThesis, {{"crane", SLEWLAB_SOURCE_DIR "/config/cranes/no_load.yaml"}});
  EXPECT_EQ(scenario.crane.parameters.load.mass, 0.0);
}

TEST(ScenarioFile, ConfigurationTextTellsEveryPartApart) {
  const std::string thesis = load_scenario_file(kThesis).configuration_text;
  EXPECT_EQ(load_scenario_file(kThesis).configuration_text, thesis);
  for (const common::Override& change :
       {common::Override{"crane.load.mass", "29 t"}, common::Override{"controller.speed_control.droop", "1"},
        common::Override{"duration", "61"}, common::Override{"operator.0.speed_request", "0.5"}}) {
    EXPECT_NE(load_scenario_file(kThesis, {change}).configuration_text, thesis) << change.key;
  }
}

TEST(ScenarioFile, TimesFallOnPlantSteps) {
  EXPECT_EQ(complaint({{"controller_period", "1.5 ms"}}),
            "--set controller_period=1.5 ms: key 'controller_period': found 1.5 ms, "
            "expected a whole multiple of the plant step, 1 ms");
  for (const char* period : {"1 ms", "2 ms", "3 ms", "5 ms", "0.01 s", "20 ms"}) EXPECT_EQ(complaint({{"controller_period", period}}), "");
  EXPECT_NE(complaint({{"operator.0.time", "5.0005"}}).find("key 'operator.0.time': found 5.0005 s"),
            std::string::npos);
}

TEST(ScenarioFile, ATimeIsToldAsItWasGiven) {
  EXPECT_NE(complaint({{"operator.0.time", "0.0001"}}).find("found 0.1 ms, expected"), std::string::npos) << complaint({{"operator.0.time", "0.0001"}});
  EXPECT_NE(complaint({{"operator.0.time", "0.0006"}}).find("found 0.6 ms, expected"), std::string::npos);
}

TEST(ScenarioFile, BadValuesAreExplained) {
  EXPECT_EQ(complaint({{"operator.1.time", "4"}}),
            "--set operator.1.time=4: key 'operator.1.time': found 4 s, "
            "expected later than the move before, 5 s");
  EXPECT_EQ(complaint({{"operator.1.time", "4 t"}}),  // and nothing of a time that was not read
            "--set operator.1.time=4 t: key 'operator.1.time': found the unit 't', which measures something else, "
            "expected one of s, ms, us, min, h");
  EXPECT_EQ(complaint({{"operator.0.speed_request", "1.5"}}),
            "--set operator.0.speed_request=1.5: key 'operator.0.speed_request': found 1.5, "
            "expected a number from -1 to 1");
  EXPECT_EQ(complaint({{"crane", "nowhere.yaml"}, {"crane.load.mass", "3 t"}}),
            "--set crane=nowhere.yaml: key 'crane': found 'nowhere.yaml', which cannot be read, expected the name of a readable file");
  EXPECT_EQ(complaint({{"controller", "nowhere.yaml"}}),
            "--set controller=nowhere.yaml: key 'controller': found 'nowhere.yaml', which cannot be read, expected the name of a readable file");
  EXPECT_NE(complaint({{"crane", SLEWLAB_SOURCE_DIR "/config/controllers/thesis.yaml"}})
                .find("config/controllers/thesis.yaml:1:7: key 'kind': found controller, expected crane"),
            std::string::npos);
  // A crane's problem is told with the key as it was given.
  EXPECT_EQ(complaint({{"crane.load.mass", "-1 t"}}).find("--set crane.load.mass=-1 t: key 'crane.load.mass': found -1 t"), 0u)
      << complaint({{"crane.load.mass", "-1 t"}});
  EXPECT_EQ(complaint({{"crane.load.mas", "1"}}).find("--set crane.load.mas=1: key 'crane.load.mas': found "), 0u)
      << complaint({{"crane.load.mas", "1"}});
  EXPECT_EQ(complaint({{"crane.load.mass", "60000"}}).find("--set crane.load.mass=60000: key 'crane.load.mass': found 60000 without a unit"), 0u)
      << complaint({{"crane.load.mass", "60000"}});
}

// Hoisting, luffing and travelling are asked of the crane; only what the slewing joystick does becomes an OPERATOR.
TEST(ScenarioFile, OtherMotionsAreNoMovesOfTheJoystick) {
  const std::string file = SLEWLAB_SOURCE_DIR "/config/scenarios/moves_while_slewing.yaml";
  const Scenario scenario = load_scenario_file(file);
  ASSERT_EQ(scenario.moves.size(), 2u);
  EXPECT_EQ(scenario.moves[1].time, 40'000'000'000);
  ASSERT_EQ(scenario.motion_requests.hoisting.size(), 2u);
  EXPECT_EQ(scenario.motion_requests.hoisting[1].time, 22'000'000'000);
  EXPECT_EQ(scenario.motion_requests.hoisting[1].share, 0.0);
  EXPECT_EQ(scenario.motion_requests.luffing[0].share, -1.0);
  EXPECT_EQ(scenario.motion_requests.travelling.size(), 2u);
  EXPECT_TRUE(load_scenario_file(kThesis).motion_requests.empty());
  EXPECT_EQ(load_scenario_file(SLEWLAB_SOURCE_DIR "/config/scenarios/a_frame_luffing.yaml").motion_requests.luffing.size(), 4u);

  // An emergency stop ends what moves, and nothing else.
  const Scenario stopped = load_scenario_file(file, {{"operator.3.emergency_stop", "{value: true, source: test}"}});
  EXPECT_EQ(stopped.motion_requests.hoisting.size(), 2u);
  EXPECT_EQ(stopped.motion_requests.luffing.back().time, 22'000'000'000);
  EXPECT_EQ(stopped.moves.size(), 3u);
}

TEST(ScenarioFile, MotionsThatTheCraneCannotDoAreExplained) {
  const std::string file = SLEWLAB_SOURCE_DIR "/config/scenarios/moves_while_slewing.yaml";
  const auto told = [&](const std::vector<common::Override>& overrides) -> std::string {
    try {
      load_scenario_file(file, overrides);
    } catch (const common::InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(told({{"crane", SLEWLAB_SOURCE_DIR "/config/cranes/thesis.yaml"}}).find("moves_while_slewing.yaml:15:23: key 'operator.0.hoisting_request': found a request, expected no such request, or a section 'hoisting'"),
            std::string::npos);
  EXPECT_NE(told({{"crane.load.rope_length", "15 m"}}).find("moves_while_slewing.yaml:15:23: key 'operator.0.hoisting_request': found a hook hoisted until 5"), std::string::npos) << told({{"crane.load.rope_length", "15 m"}});
  EXPECT_NE(told({{"crane.luffing.lowest_angle", "50 deg"}}).find("moves_while_slewing.yaml:19:22: key 'operator.2.luffing_request': found a boom luffed from 43.5 deg to 53.5 deg"), std::string::npos)
      << told({{"crane.luffing.lowest_angle", "50 deg"}});
  EXPECT_NE(told({{"operator.0.hoisting_request", "1.5"}}).find("found 1.5, expected a number from -1 to 1"), std::string::npos);
}

}  // namespace
}  // namespace slewlab::sim
