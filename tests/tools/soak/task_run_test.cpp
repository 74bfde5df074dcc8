// Whole tasks through the real loop: they repeat to the bit, the invariants hold in them, and a limit that is too narrow
// or a controller that is wrong is noticed.

#include "tools/soak/task_run.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "common/input_error.h"
#include "msgs/configuration_hash.h"
#include "msgs/run_log.h"
#include "sim/drive/scenario_file.h"
#include "tests/msgs/file_contents.h"
#include "tests/msgs/temporary_folder.h"

namespace slewlab::tools {
namespace {

namespace fs = std::filesystem;

const fs::path kConfig = fs::path(SLEWLAB_SOURCE_DIR) / "config";
const auto kGoOn = [] { return false; };

SoakPlan plan_with(const std::vector<common::Override>& changes, bool faults = false) {
  SoakPlan plan;
  plan.crane = kConfig / "cranes/thesis.yaml";
  plan.controller = kConfig / "controllers/thesis.yaml";
  plan.settings = load_soak_settings(kConfig / "soak/thesis.yaml", changes);
  plan.faults = faults;
  plan.seed = 11;
  return plan;
}

bool has(const TaskResult& result, Invariant invariant) {
  return std::any_of(result.violations.begin(), result.violations.end(),
                     [&](const Violation& one) { return one.invariant == invariant; });
}

TEST(TaskRun, RepeatsToTheBit) {
  const TemporaryFolder folder;
  const SoakPlan plan = plan_with({{"task.duration", "20"}}, true);
  for (const int number : {0, 1, 2}) {
    const TaskResult first = run_task(plan, number, folder.path() / "first", kGoOn);
    const TaskResult second = run_task(plan, number, folder.path() / "second", kGoOn);
    EXPECT_TRUE(first.complete);
    EXPECT_EQ(first.simulated_time, 20'000'000'000);
    EXPECT_EQ(first.log_digest, second.log_digest);
    EXPECT_TRUE(contents(folder.path() / "first/run.lcmlog") == contents(folder.path() / "second/run.lcmlog"));
  }
  EXPECT_NE(run_task(plan, 0, folder.path() / "first", kGoOn).log_digest,
            run_task(plan, 1, folder.path() / "second", kGoOn).log_digest);
}

// Twelve simulated minutes with faults and twelve without: nothing breaks, and something happened.
TEST(TaskRun, InvariantsHold) {
  const TemporaryFolder folder;
  for (const bool faults : {false, true}) {
    const SoakPlan plan = plan_with({{"task.duration", "24"}}, faults);
    std::int64_t trips = 0, crossings = 0;
    double speed = 0.0;
    for (int number = 0; number < 30; ++number) {
      const TaskResult result = run_task(plan, number, folder.path() / "run", kGoOn);
      for (const Violation& one : result.violations) {
        ADD_FAILURE() << "task " << number << ": " << name_of(one.invariant) << ": " << one.what;
      }
      trips += result.trips;
      crossings += result.play_crossings;
      speed = std::max(speed, result.house_speed);
    }
    EXPECT_EQ(trips > 0, faults);
    EXPECT_GT(crossings, 0);
    EXPECT_GT(speed, 0.045);  // [rad/s] of the 0.05 that the controller may give
  }
}

TEST(TaskRun, ALimitThatIsTooNarrowIsNoticedWhereItIsPassed) {
  const TemporaryFolder folder;
  const SoakPlan plan = plan_with({{"limits.house_speed", "0.01"}, {"task.duration", "30"}});
  const TaskResult result = run_task(plan, 1, folder.path() / "run", kGoOn);
  ASSERT_EQ(result.violations.size(), 1u);
  EXPECT_EQ(result.violations[0].invariant, Invariant::speed_limit);
  // The log says the same: TRUTH behind that instant is the first beyond 0.01 rad/s.
  const msgs::RunLogs logs = msgs::read_run_logs(folder.path() / "run/run.lcmlog");
  for (const msgs::Truth& truth : logs.runs.at(0).truth) {
    if (truth.simulated_time < result.violations[0].time) { EXPECT_LE(std::abs(truth.house_speed), 0.01); }
  }
  EXPECT_GT(result.house_speed, 0.01);
}

// A drive with a rate limit that the controller was not told: the drive limits the torque, and without a fault on
// purpose that is trouble.
TEST(TaskRun, ADriveThatHasToStepInIsTrouble) {
  const TemporaryFolder folder;
  SoakPlan plan = plan_with({{"task.duration", "20"}});
  plan.overrides = {{"crane.drive_protection.torque_rate_limit", "500"}};
  EXPECT_TRUE(has(run_task(plan, 0, folder.path() / "run", kGoOn), Invariant::untroubled));
}

// A boom that buckles cannot be built: the task is a finding, the soak goes on.
TEST(TaskRun, WhatStopsARunIsAViolationOfItsOwn) {
  const TemporaryFolder folder;
  SoakPlan plan = plan_with({{"task.duration", "20"}});
  plan.overrides = {{"crane.effects", "[{effect: compression_softening, compression: {value: 4e6, unit: N, source: test}}]"},
                    {"crane.boom.youngs_modulus", "1 GPa"}};
  const TaskResult result = run_task(plan, 0, folder.path() / "run", kGoOn);
  ASSERT_EQ(result.violations.size(), 1u);
  EXPECT_EQ(result.violations[0].invariant, Invariant::finished);
  EXPECT_NE(result.violations[0].what.find("buckles"), std::string::npos) << result.violations[0].what;
}

// A wrong file is no finding: it ends the soak.
TEST(TaskRun, AnEffectThatIsNotThereIsTheCallersMistake) {
  const TemporaryFolder folder;
  SoakPlan plan = plan_with({{"task.duration", "20"}});
  plan.overrides = {{"crane.effects", "[{effect: no_such_effect}]"}};
  EXPECT_THROW(run_task(plan, 0, folder.path() / "run", kGoOn), common::InputError);
}

TEST(TaskRun, StopsWhenAsked) {
  const TemporaryFolder folder;
  int asked = 0;
  const TaskResult result =
      run_task(plan_with({{"task.duration", "20"}}), 0, folder.path() / "run", [&] { return ++asked > 1000; });
  EXPECT_FALSE(result.complete);
  EXPECT_LT(result.simulated_time, 20'000'000'000);
}

TEST(TaskRun, TheKeptFolderIsARunLikeAnyOther) {
  const TemporaryFolder folder;
  SoakPlan plan = plan_with({{"task.duration", "10"}}, true);
  plan.overrides = {{"crane.drive.motor_inertia", "1.2"}, {"controller.ramp.curved_share", "0.2"}};
  run_task(plan, 3, folder.path(), kGoOn);
  keep_configuration(plan, 3, folder.path());
  const sim::Scenario scenario = sim::load_scenario_file(folder.path() / "scenario.yaml");
  EXPECT_EQ(scenario.crane.parameters.drive.motor_inertia, 1.2);
  EXPECT_FALSE(fs::exists(folder.path() / "task.yaml"));
  const msgs::RunLogs logs = msgs::read_run_logs(folder.path() / "run.lcmlog");
  EXPECT_EQ(logs.runs.at(0).configuration_hash, msgs::configuration_hash(scenario.configuration_text));
}

}  // namespace
}  // namespace slewlab::tools
