#include "tools/commands/run_facts.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "controller/controller_file.h"
#include "sim/analysis/eigen.h"

namespace slewlab::tools {
namespace {

const std::filesystem::path kScenario = SLEWLAB_SOURCE_DIR "/config/scenarios/thesis_slew.yaml";

TEST(RunFacts, SayWhatTheScenarioAndItsFilesSay) {
  const sim::Scenario scenario = sim::load_scenario_file(kScenario, {{"crane.drive.pinion_ratio", "10"}});
  const auto controller = controller::load_controller_file(scenario.controller_file).settings;
  const auto facts = nlohmann::json::parse(
      run_facts(scenario, controller, {.simulated_time = 60.0, .wall_time = 3.0, .cycles = 6000}));

  EXPECT_EQ(facts["rated_torque"], controller.rated_torque);
  EXPECT_EQ(facts["total_ratio"], controller.total_ratio);
  EXPECT_EQ(facts["play_compensation"], true);
  EXPECT_EQ(facts["duration"], 60.0);
  EXPECT_EQ(facts["simulated_time"], 60.0);
  EXPECT_EQ(facts["cycles"], 6000);
  EXPECT_EQ(facts["end"], "complete");
  // The override reached the crane: both plays in series on the slew axis, thesis 2.6.1, halved.
  const auto& drive = scenario.crane.parameters.drive;
  EXPECT_NEAR(facts["half_play"].get<double>(), 0.5 * (drive.gearbox_play + drive.pinion_play) / 10.0, 1e-9);
}

TEST(RunFacts, NameTheModesOfTheWholeCraneByKindAndCount) {
  const sim::Scenario scenario = sim::load_scenario_file(kScenario);
  const auto controller = controller::load_controller_file(scenario.controller_file).settings;
  const auto facts = nlohmann::json::parse(run_facts(scenario, controller, {}));
  const auto modes = sim::crane_modes(scenario.crane.parameters);
  int found = 0;
  for (const auto& mode : facts["modes"]) {
    if (mode["name"] == "bending 2") {
      EXPECT_EQ(mode["frequency"], sim::frequency_of(modes, sim::ModeKind::kBending, 2));
      EXPECT_NEAR(mode["frequency"].get<double>(), 5.24, 0.05 * 5.24);  // thesis Table 4.1, its 5 %
      ++found;
    }
    EXPECT_GT(mode["frequency"], 0.0) << "a rigid mode is none to mark";
  }
  EXPECT_EQ(found, 1);
}

TEST(RunFacts, LeaveOutWhatOnlyTheControllersFileKnows) {
  const auto facts = nlohmann::json::parse(run_facts(sim::load_scenario_file(kScenario), std::nullopt, {}));
  EXPECT_FALSE(facts.contains("rated_torque"));
  EXPECT_FALSE(facts.contains("play_compensation"));
  EXPECT_TRUE(facts.contains("modes"));
}

TEST(RunFacts, AreWrittenWholeOrNotAtAll) {
  const sim::Scenario scenario = sim::load_scenario_file(kScenario);
  const auto controller = controller::load_controller_file(scenario.controller_file).settings;
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "run_facts_test";
  std::filesystem::remove_all(folder);
  EXPECT_THROW(write_run_facts(folder, scenario, controller, {}), std::runtime_error);

  std::filesystem::create_directories(folder);
  write_run_facts(folder, scenario, controller, {});
  std::ifstream file(folder / kRunFactsName);
  EXPECT_FALSE(nlohmann::json::parse(file).empty());
  EXPECT_FALSE(std::filesystem::exists(folder / "run.json.partial"));
}

}  // namespace
}  // namespace slewlab::tools
