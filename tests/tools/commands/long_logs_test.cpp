#include "tools/commands/long_logs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "diagnosis/stretch.h"
#include "tests/msgs/logged_log.h"
#include "tests/msgs/temporary_folder.h"

namespace slewlab::tools {
namespace {

constexpr std::int64_t kSecond = 1000000000;  // [ns]

class LongLogs : public testing::Test {
 protected:
  // A motor that turns for 10 s of every 30 s, each time faster than before by 1 rad/s, read ten times a second.
  LoggedRun worked(const std::string& name, int moves) const;
  LoggedRuns logs(std::vector<std::pair<std::string, int>> moves) const {
    LoggedRuns logged;
    for (const auto& [name, count] : moves) logged.runs.push_back(worked(name, count));
    return logged;
  }

 private:
  TemporaryFolder folder_;
};

LoggedRun LongLogs::worked(const std::string& name, int moves) const {
  msgs::RunLog run;
  double position = 0.0;
  for (int n = 0; n <= 300 * moves; ++n) {
    msgs::Encoder encoder{};
    encoder.simulated_time = n * kSecond / 10;
    encoder.group_count = 1;
    encoder.shaft_position = {position};
    encoder.shaft_speed = {0.0};
    run.encoder.push_back(encoder);
    const int second = n / 10 % 30;
    if (second >= 10 && second < 20) position += 0.1 * (1.0 + n / 300);
  }
  return {name, msgs::logged(run, folder_.path() / (name + ".lcmlog")), {name + " was read"}};
}

LongLogSettings settings_of(double most) {
  return {most, 20.0, 1.0, 0.3, [](const MeasuredRun&) { return 1.0; }};
}

bool is_said(const MeasuredRun& one, const std::string& words) {
  return std::any_of(one.remarks.begin(), one.remarks.end(), [&](const std::string& remark) { return remark.find(words) != std::string::npos; });
}

TEST_F(LongLogs, WhatIsFittedWholeStaysAsItIs) {
  LoggedRuns logged = logs({{"a", 2}, {"b", 3}});
  const auto [measured, unseen] = fitted_runs(settings_of(150.0), std::move(logged));
  EXPECT_TRUE(unseen.runs.empty());
  EXPECT_EQ(measured.runs[0].name, "a");
  EXPECT_DOUBLE_EQ(diagnosis::length_of(measured.runs[1].run), 90.0);
}

// The fastest move is the last one, the next one the one before; what is said of the log stays with it.
TEST_F(LongLogs, OfALongOneWhereMostMovesAndTheNextTriesTheAnswer) {
  LoggedRuns logged = logs({{"a", 10}});
  const auto [measured, unseen] = fitted_runs(settings_of(25.0), std::move(logged));
  ASSERT_EQ(measured.runs.size(), 1u);
  ASSERT_EQ(unseen.runs.size(), 1u);
  const auto begins = [](const MeasuredRun& one) { return 1e-9 * static_cast<double>(one.run.encoder.front().simulated_time); };
  EXPECT_NEAR(begins(measured.runs[0]), 270.0, 10.0);
  EXPECT_NEAR(begins(unseen.runs[0]), 240.0, 10.0);
  EXPECT_TRUE(is_said(measured.runs[0], "a was read"));
  EXPECT_TRUE(is_said(measured.runs[0], "a: of its 300 s " + measured.runs[0].name.substr(2) + " are fitted, where most moves, and " + unseen.runs[0].name.substr(2) + " try the answer"));
}

// A stretch that is refused, or lies near impacts for the most part, gives way to the next one, and it is said.
TEST_F(LongLogs, WhatCannotBeJudgedIsPassedOver) {
  LoggedRuns logged = logs({{"a", 10}});
  LongLogSettings settings = settings_of(25.0);
  int asked = 0;
  settings.judged_share = [&](const MeasuredRun& part) -> double {
    if (asked++ == 0) throw std::runtime_error(part.name + ": the drives are tripped");
    return asked == 2 ? 0.2 : 0.9;
  };
  const auto [measured, unseen] = fitted_runs(settings, std::move(logged));
  ASSERT_EQ(unseen.runs.size(), 1u);
  EXPECT_NEAR(1e-9 * static_cast<double>(measured.runs[0].run.encoder.front().simulated_time), 210.0, 10.0);
  EXPECT_TRUE(is_said(measured.runs[0], "the drives are tripped"));
  EXPECT_TRUE(is_said(measured.runs[0], "20 % of it lie away from impacts"));
}

TEST_F(LongLogs, OneOfWhichNothingCanBeJudgedStaysAndSaysItselfWhy) {
  LoggedRuns logged = logs({{"a", 10}});
  LongLogSettings settings = settings_of(25.0);
  settings.judged_share = [](const MeasuredRun&) -> double { throw std::runtime_error("no"); };
  const auto [measured, unseen] = fitted_runs(settings, std::move(logged));
  EXPECT_TRUE(unseen.runs.empty());
  EXPECT_DOUBLE_EQ(diagnosis::length_of(measured.runs[0].run), 300.0);
  EXPECT_EQ(measured.runs[0].name, "a");
}

// Of 40 s two stretches of 20 s are fitted at most: of three logs those with the faster moves.
TEST_F(LongLogs, OfManyLogsThoseInWhichMostMoves) {
  LoggedRuns logged = logs({{"slow", 2}, {"fast", 9}, {"middle", 4}});
  const auto [measured, unseen] = fitted_runs(settings_of(40.0), std::move(logged));
  ASSERT_EQ(measured.runs.size(), 2u);
  EXPECT_EQ(measured.runs[0].name.rfind("fast ", 0), 0u);
  EXPECT_EQ(measured.runs[1].name.rfind("middle ", 0), 0u);
  EXPECT_TRUE(is_said(measured.runs[1], "slow: left out")) << measured.runs[1].remarks.back();
}

}  // namespace
}  // namespace slewlab::tools
