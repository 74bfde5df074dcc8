// Every scenario of config/scenarios/faults with its own `expect:`, with our controller, in one process on a bus in
// memory; each runs twice and must give the same log, byte for byte.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "controller/controller_file.h"
#include "diagnosis/loop/wire_loop.h"
#include "msgs/log_writer.h"
#include "msgs/run_log.h"
#include "sim/drive/crane_plant.h"
#include "sim/drive/fault_expectation.h"
#include "sim/drive/fault_file.h"
#include "sim/drive/scenario_run.h"
#include "tests/msgs/file_contents.h"
#include "tests/msgs/temporary_folder.h"
#include "tests/sim/scaled_crane.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::sim {
namespace {

namespace fs = std::filesystem;

const fs::path kFolder = fs::path(SLEWLAB_SOURCE_DIR) / "config/scenarios/faults";

std::vector<std::string> scenario_names() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(kFolder)) names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

void run(const Scenario& scenario, const fs::path& log_file) {
  controller::ControllerSettings settings =
      controller::load_controller_file(scenario.controller_file, scenario.controller_overrides).settings;
  settings.period = static_cast<double>(scenario.controller_period) * 1e-9;
  CranePlant plant(machine_settings(scenario), drive_run(scenario));
  msgs::LogWriter log(log_file);
  const diagnosis::WireLoopResult result = diagnosis::run_wire_loop(lockstep_settings(scenario), settings, plant, log);
  log.finish();
  EXPECT_FALSE(result.controller_is_dead) << "nobody answers any more at " << result.counts.simulated_time << " ns";
}

class FaultScenarioTest : public testing::TestWithParam<std::string> {};

TEST_P(FaultScenarioTest, HappensAsExpectedAndTheSameWayTwice) {
  const Scenario scenario = load_scenario_file(kFolder / (GetParam() + ".yaml"));
  ASSERT_FALSE(scenario.faults.empty());
  const TemporaryFolder folder;
  run(scenario, folder.path() / "first.lcmlog");
  run(scenario, folder.path() / "second.lcmlog");
  EXPECT_TRUE(contents(folder.path() / "first.lcmlog") == contents(folder.path() / "second.lcmlog"));
  const msgs::RunLogs logs = msgs::read_run_logs(folder.path() / "first.lcmlog");
  for (const std::string& broken : broken_expectations(scenario.expectation, logs.runs.at(0))) ADD_FAILURE() << broken;
}

INSTANTIATE_TEST_SUITE_P(All, FaultScenarioTest, testing::ValuesIn(scenario_names()),
                         [](const auto& test) { return test.param; });

TEST(FaultScenarios, ThereAreAtLeastTenAndEachSaysWhatMustHappen) {
  EXPECT_GE(scenario_names().size(), 10u);
  for (const std::string& name : scenario_names()) {
    const std::string text = contents(kFolder / (name + ".yaml"));
    EXPECT_NE(text.find("\nexpect:\n"), std::string::npos) << name;
  }
}

TEST(FaultScenarios, WithoutItsFaultTheManoeuvreTripsNothing) {
  const Scenario scenario = load_scenario_file(kFolder.parent_path() / "fault_manoeuvre.yaml");
  const TemporaryFolder folder;
  run(scenario, folder.path() / "run.lcmlog");
  FaultExpectation calm;
  calm.drive_state = DriveState::running;
  calm.no_other_faults = true;
  calm.stale_commands = CountRange{0, 0};
  const msgs::RunLogs logs = msgs::read_run_logs(folder.path() / "run.lcmlog");
  for (const std::string& broken : broken_expectations(calm, logs.runs.at(0))) ADD_FAILURE() << broken;
}

// Whatever bit is turned over, the log is one run's. (What the drive makes of it depends on the bit.)
TEST(FaultScenarios, NoTurnedBitMakesAnotherRunOfALog) {
  for (int seed = 1; seed <= 8; ++seed) {
    const Scenario scenario = load_scenario_file(kFolder / "torque_bits.yaml", {{"seed", std::to_string(seed)}});
    const TemporaryFolder folder;
    run(scenario, folder.path() / "run.lcmlog");
    const msgs::RunLogs logs = msgs::read_run_logs(folder.path() / "run.lcmlog");
    ASSERT_EQ(logs.runs.size(), 1u) << "seed " << seed;
    const auto cycles = static_cast<std::size_t>(scenario.duration / scenario.controller_period);
    EXPECT_EQ(logs.runs[0].encoder.size(), cycles) << "seed " << seed;
    EXPECT_EQ(logs.lost_messages, 0) << "seed " << seed;
  }
}

// A tenth of what the machine covers at top speed while it gets there: 5 mrad of the thesis's crane, whatever its mass.
TEST(FaultScenarios, WhatCountsAsStandingFollowsTheMachine) {
  const double standing = load_scenario_file(kFolder / "controller_killed.yaml").expectation.standing_angle;
  EXPECT_NEAR(standing, 0.005, 0.0005);
  EXPECT_DOUBLE_EQ(standing, standing_angle_of(thesis_crane()));
  EXPECT_NEAR(standing_angle_of(with_masses_times(thesis_crane(), 1e-3)) / standing, 1.0, 1e-12);
  CraneParameters fast = thesis_crane();
  fast.drive.top_speed *= 3.0;
  EXPECT_NEAR(standing_angle_of(fast) / standing, 9.0, 1e-9);
}

TEST(FaultScenarios, AnExpectationThatDoesNotHoldIsToldWithWhatWasFound) {
  const Scenario scenario = load_scenario_file(kFolder / "controller_killed.yaml");
  const TemporaryFolder folder;
  run(scenario, folder.path() / "run.lcmlog");
  FaultExpectation wrong;
  wrong.drive_state = DriveState::running;
  wrong.trip_cause = DriveFault::power_lost;
  wrong.faults = {{DriveFault::silence, {2, 3}}};
  wrong.tip_acceleration = 0.1;
  wrong.standing_by = 9'000'000'000;
  wrong.standing_angle = scenario.expectation.standing_angle;
  wrong.slew_angle_at_least = 3.0;
  wrong.slew_angle_at_most = 0.0;
  const auto broken = broken_expectations(wrong, msgs::read_run_logs(folder.path() / "run.lcmlog").runs.at(0));
  ASSERT_EQ(broken.size(), 7u);
  EXPECT_EQ(broken[0], "drive state at the end: found braked, expected running");
  EXPECT_EQ(broken[1], "trip cause at the end: found silence, expected power_lost");
  EXPECT_EQ(broken[2], "count of silence: found 1, expected 2 to 3");
}

}  // namespace
}  // namespace slewlab::sim
