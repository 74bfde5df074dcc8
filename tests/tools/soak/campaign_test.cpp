// Campaigns with their workers: interrupted and resumed, with one worker and with three, with workers that die and
// that leak. Tasks are short; what is compared is the journal, which holds nothing that depends on the machine.

#include "tools/soak/campaign.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <vector>

#include "sim/drive/scenario_file.h"
#include "tests/msgs/file_contents.h"
#include "tests/msgs/temporary_folder.h"

namespace slewlab::tools {
namespace {

namespace fs = std::filesystem;

const fs::path kConfig = fs::path(SLEWLAB_SOURCE_DIR) / "config";

CampaignSettings settings_for(const fs::path& out, int jobs, std::vector<common::Override> changes = {}) {
  changes.push_back({"task.duration", "6"});
  CampaignSettings settings;
  settings.plan.crane = kConfig / "cranes/thesis.yaml";
  settings.plan.controller = kConfig / "controllers/thesis.yaml";
  settings.plan.settings = load_soak_settings(kConfig / "soak/thesis.yaml", changes);
  settings.plan.seed = 5;
  settings.plan.faults = true;
  settings.task_count = 12;
  settings.jobs = jobs;
  settings.out = out;
  settings.command = "slewlab soak --seed 5 --task";
  return settings;
}

std::vector<std::string> lines(const fs::path& file) {
  std::ifstream in(file);
  std::vector<std::string> result;
  for (std::string line; std::getline(in, line);) result.push_back(line);
  return result;
}

// The journal without its order.
std::vector<std::string> sorted_journal(const fs::path& out) {
  std::vector<std::string> result = lines(out / "journal.jsonl");
  std::sort(result.begin(), result.end());
  return result;
}

TEST(Campaign, AnyNumberOfWorkersAndInterruptionsWritesTheSameJournal) {
  const TemporaryFolder folder;
  const CampaignReport whole = run_campaign(settings_for(folder.path() / "one", 1), {});
  EXPECT_TRUE(whole.complete);
  EXPECT_EQ(whole.progress.done, 12);
  EXPECT_EQ(whole.progress.failed, 0);
  EXPECT_EQ(lines(folder.path() / "one/journal.jsonl").size(), 13u);
  EXPECT_FALSE(fs::exists(folder.path() / "one/running"));

  run_campaign(settings_for(folder.path() / "three", 3), {});
  EXPECT_EQ(sorted_journal(folder.path() / "one"), sorted_journal(folder.path() / "three"));

  const fs::path parts = folder.path() / "parts";
  int sessions = 0;
  bool complete = false;
  while (!complete) {
    ASSERT_LT(++sessions, 20);
    std::int64_t done_here = 0;
    CampaignHooks hooks;
    hooks.progress = [&](const CampaignProgress& now) { done_here = now.done_here; };
    hooks.stop = [&] { return done_here >= 4; };
    const CampaignReport part = run_campaign(settings_for(parts, 2), hooks);
    complete = part.complete;
  }
  EXPECT_GE(sessions, 2);
  EXPECT_EQ(sorted_journal(folder.path() / "one"), sorted_journal(parts));
}

TEST(Campaign, GoesOnBehindALineThatWasCutOff) {
  const TemporaryFolder folder;
  run_campaign(settings_for(folder.path(), 1), {});
  const auto whole = sorted_journal(folder.path());
  const std::string text = contents(folder.path() / "journal.jsonl");
  std::ofstream(folder.path() / "journal.jsonl", std::ios::trunc) << text.substr(0, text.size() - 40);
  const CampaignReport report = run_campaign(settings_for(folder.path(), 1), {});
  EXPECT_EQ(report.progress.done_here, 1);
  EXPECT_EQ(sorted_journal(folder.path()), whole);
}

TEST(Campaign, CanBeMadeLonger) {
  const TemporaryFolder folder;
  CampaignSettings settings = settings_for(folder.path(), 1);
  settings.task_count = 3;
  run_campaign(settings, {});
  settings.task_count = 5;
  const CampaignReport report = run_campaign(settings, {});
  EXPECT_EQ(report.progress.done, 5);
  EXPECT_EQ(report.progress.done_here, 2);
}

TEST(Campaign, RefusesTheJournalOfAnotherOne) {
  const TemporaryFolder folder;
  CampaignSettings settings = settings_for(folder.path(), 1);
  settings.task_count = 1;
  run_campaign(settings, {});
  const auto refusal = [&](const CampaignSettings& other) -> std::string {
    try {
      run_campaign(other, {});
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "taken";
  };
  CampaignSettings other = settings;
  other.plan.seed = 6;
  EXPECT_NE(refusal(other).find("another campaign: seed is 5 there and 6 here"), std::string::npos) << refusal(other);
  other = settings;
  other.plan.faults = false;
  EXPECT_NE(refusal(other).find("faults is true there and false here"), std::string::npos) << refusal(other);
  other = settings;
  other.plan.overrides = {{"crane.drive.motor_inertia", "1.2"}};
  EXPECT_NE(refusal(other).find("configuration is"), std::string::npos) << refusal(other);
  std::ofstream(folder.path() / "journal.jsonl", std::ios::trunc) << "something else\n";
  EXPECT_NE(refusal(settings).find("no journal of a soak"), std::string::npos) << refusal(settings);
}

TEST(Campaign, AFailureLeavesSeedLogReasonAndCommand) {
  const TemporaryFolder folder;
  CampaignSettings settings = settings_for(folder.path(), 2, {{"limits.house_speed", "1e-4"}});
  settings.plan.faults = false;
  settings.task_count = 3;
  std::vector<std::string> told;
  CampaignHooks hooks;
  hooks.failure = [&](const std::string& text) { told.push_back(text); };
  const CampaignReport report = run_campaign(settings, hooks);
  EXPECT_TRUE(report.complete);
  ASSERT_FALSE(report.failed_tasks.empty());
  EXPECT_EQ(told.size(), report.failed_tasks.size());
  const std::int64_t number = report.failed_tasks.front();
  const fs::path kept = folder.path() / "failures" / ("task-00000" + std::to_string(number));
  const std::string text = contents(kept / "failure.txt");
  EXPECT_NE(text.find("seed 5, task " + std::to_string(number)), std::string::npos) << text;
  EXPECT_NE(text.find("speed_limit at "), std::string::npos) << text;
  EXPECT_NE(text.find("rad/s, more than 0.0001 rad/s"), std::string::npos) << text;
  EXPECT_NE(text.find("again: slewlab soak --seed 5 --task " + std::to_string(number) + "\n"), std::string::npos) << text;

  // Run again by itself it breaks in the same way, and its log is the same.
  const TaskResult again = run_task(settings.plan, number, folder.path() / "again", [] { return false; });
  EXPECT_EQ(failure_text(again, settings.plan, settings.command + " " + std::to_string(number)), text);
  EXPECT_TRUE(contents(kept / "run.lcmlog") == contents(folder.path() / "again/run.lcmlog"));
  EXPECT_EQ(sim::load_scenario_file(kept / "scenario.yaml").duration, 6'000'000'000);
}

TEST(Campaign, AWorkerThatDiesTakesOnlyItsTaskWithIt) {
  const TemporaryFolder folder;
  CampaignSettings settings = settings_for(folder.path(), 2);
  settings.task_count = 6;
  CampaignHooks hooks;
  hooks.in_worker = [](std::int64_t number) {
    if (number == 2) std::raise(SIGKILL);
  };
  const CampaignReport report = run_campaign(settings, hooks);
  EXPECT_TRUE(report.complete);
  EXPECT_EQ(report.failed_tasks, std::vector<std::int64_t>{2});
  const std::string text = contents(folder.path() / "failures/task-000002/failure.txt");
  EXPECT_NE(text.find("finished at 0.000 s: the worker was ended by signal 9"), std::string::npos) << text;
  EXPECT_TRUE(fs::exists(folder.path() / "failures/task-000002/scenario.yaml"));
}

TEST(Campaign, AWorkerThatLeaksIsNoticed) {
#ifdef SLEWLAB_SANITIZED
  GTEST_SKIP() << "the sanitizer's allocator does not count here";
#endif
  const TemporaryFolder folder;
  CampaignSettings settings = settings_for(folder.path(), 1);
  CampaignHooks hooks;
  hooks.in_worker = [](std::int64_t) {
    constexpr std::size_t kLeak = 100 * 1024;  // three tasks behind the fifth are more than limits.heap_growth
    static std::vector<void*> leaked;
    leaked.push_back(std::malloc(kLeak));
  };
  const CampaignReport report = run_campaign(settings, hooks);
  ASSERT_FALSE(report.failed_tasks.empty());
  EXPECT_EQ(report.failed_tasks.front(), 7);  // the eighth task is the third behind the fifth: 300 kB
  const std::string text = contents(folder.path() / "failures/task-000007/failure.txt");
  EXPECT_NE(text.find("memory at "), std::string::npos) << text;
  EXPECT_NE(text.find("again: slewlab soak --seed 5 --task 0-7\n"), std::string::npos) << text;
}

TEST(Campaign, AWrongFileEndsItWithOneLine) {
  const TemporaryFolder folder;
  CampaignSettings settings = settings_for(folder.path(), 1);
  settings.plan.overrides = {{"crane.effects", "[{effect: no_such_effect}]"}};
  EXPECT_THROW(run_campaign(settings, {}), std::runtime_error);
}

}  // namespace
}  // namespace slewlab::tools
