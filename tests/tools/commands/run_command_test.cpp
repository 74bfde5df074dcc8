// `slewlab run` as a user starts it, in a private network. No test waits for a time: each waits for a line
// of output or for the end of a process.

#include "tools/commands/run_command.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>

#include "msgs/log_reader.h"
#include "msgs/run_log.h"
#include "tests/msgs/file_contents.h"
#include "tests/msgs/temporary_folder.h"
#include "tests/tools/running_program.h"

namespace slewlab::tools {
namespace {

namespace fs = std::filesystem;

const std::string kSlewlab = SLEWLAB_BINARY_DIR "/bin/slewlab";
const std::string kPlant = SLEWLAB_BINARY_DIR "/bin/slewlab-plant";
const std::string kController = SLEWLAB_BINARY_DIR "/bin/slewlab-controller";
const std::string kScenario = SLEWLAB_SOURCE_DIR "/config/scenarios/thesis_slew.yaml";

class RunCommandTest : public testing::Test {
 protected:
  std::vector<std::string> command(std::vector<std::string> more = {}) const {
    std::vector<std::string> all{kSlewlab, "run", kScenario, "--out", out_.string(), "--progress", "lines"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  // So long that it is certainly under way when a test does something to it.
  std::vector<std::string> long_command(std::vector<std::string> more = {}) const {
    more.insert(more.end(), {"--set", "duration=100000"});
    return command(more);
  }
  static bool advanced(const std::string& line) {
    return line.find(" s simulated") != std::string::npos && line.find(": 0.0 of") == std::string::npos;
  }
  nlohmann::json summary() const { return nlohmann::json::parse(contents(out_ / "summary.json")); }

  // The log so far is there, readable to its last whole message, and does not pass for a complete one.
  void expect_partial_log() const {
    EXPECT_FALSE(fs::exists(out_ / "run.lcmlog"));
    msgs::LogReader reader(out_ / "run.lcmlog.partial");
    msgs::LogEvent event;
    std::int64_t events = 0;
    while (reader.next(event)) EXPECT_EQ(event.number, events++);
    EXPECT_GT(events, 0);
    EXPECT_EQ(reader.damage().skipped_bytes, 0);
  }

  TemporaryFolder folder_;
  fs::path out_ = folder_.path() / "out";
};

TEST_F(RunCommandTest, ACompleteRunLeavesItsFilesAndNoProcess) {
  RunningProgram run(command({"--set", "duration=2"}));
  EXPECT_EQ(run.wait_for_end(), 0) << run.complaints();
  wait_until_nothing_is_left();
  EXPECT_FALSE(fs::exists(out_ / "run.lcmlog.partial"));
  EXPECT_EQ(summary()["outcome"], "complete");
  EXPECT_EQ(summary()["run"]["lockstep_cycles"], 200);  // 2 s every 10 ms
  const msgs::RunLogs logs = msgs::read_run_logs(out_ / "run.lcmlog");
  ASSERT_EQ(logs.runs.size(), 1u);
  EXPECT_TRUE(logs.remarks.empty()) << logs.remarks.front();
  EXPECT_EQ(logs.runs[0].encoder.size(), 200u);
  EXPECT_EQ(logs.runs[0].torque.size(), 200u);
  EXPECT_EQ(logs.runs[0].controller_state.size(), 200u);
}

TEST_F(RunCommandTest, NothingOfAnEarlierRunStaysBesideTheNewLog) {
  fs::create_directories(out_ / "run_parquet");
  fs::create_directories(out_ / "run_csv");
  const auto write = [&](const char* name) { std::ofstream(out_ / name) << "of an earlier run"; };
  for (const char* name : {"report.html", "run.html", "acceptance.json", "acceptance.html", "run.mcap", "run.lcmlog.partial", "run_parquet/TRUTH.parquet", "notes.txt",
                           "run_csv/TRUTH.csv", "run_csv/mine.txt"}) {
    write(name);
  }
  RunningProgram run(command({"--set", "duration=1"}));
  ASSERT_EQ(run.wait_for_end(), 0) << run.complaints();
  for (const char* name : {"report.html", "run.html", "acceptance.json", "acceptance.html", "run.mcap", "run.lcmlog.partial", "run_parquet"}) EXPECT_FALSE(fs::exists(out_ / name)) << name;
  EXPECT_TRUE(fs::exists(out_ / "run_csv/mine.txt")) << "a folder with something else in it is the user's";
  EXPECT_TRUE(fs::exists(out_ / "notes.txt"));
}

// Of the desk: it includes scenario.yaml beside it.
TEST_F(RunCommandTest, AFolderInWhichWasSteeredIsNotWrittenOver) {
  fs::create_directories(out_);
  std::ofstream(out_ / "steered.yaml") << "include: scenario.yaml\n";
  std::ofstream(out_ / "report.html") << "of that run";
  RunningProgram run(command({"--set", "duration=1"}));
  EXPECT_EQ(run.wait_for_end(), 2);
  EXPECT_NE(run.complaints().find("--out: found '" + out_.string() + "', whose steered.yaml repeats what was steered there"), std::string::npos) << run.complaints();
  EXPECT_TRUE(fs::exists(out_ / "report.html"));
  EXPECT_FALSE(fs::exists(out_ / "run.lcmlog"));
}

TEST_F(RunCommandTest, WhatAControllerThatDoesNotAnswerSaidIsTold) {
  RunningProgram run(long_command({"--controller", "echo no server at 10.0.0.1 >&2; exec sleep 1000"}));
  const std::string line = run.wait_for_line("waiting for the controller for ");
  EXPECT_NE(line.find("; it said last: no server at 10.0.0.1"), std::string::npos) << line;
  ::kill(run.pid(), SIGINT);
  EXPECT_EQ(run.wait_for_end(), 128 + SIGINT);
}

// Against the wall clock, too, where the first answer is waited for.
TEST_F(RunCommandTest, WithoutProgressARunThatWaitsSaysSoOnceOnStandardError) {
  for (const bool realtime : {false, true}) {
    std::vector<std::string> line{"/bin/sh", "-c", "exec \"$0\" \"$@\" 2>&1 >/dev/null", kSlewlab, "run", kScenario, "--out", out_.string(),
                                  "--progress", "none", "--set", "duration=3600", "--controller", "echo no server at 10.0.0.1 >&2; exec sleep 1000"};
    if (realtime) line.push_back("--realtime");
    RunningProgram run(line);
    const std::string said = run.wait_for_line("waiting for the controller for ");
    EXPECT_NE(said.find("; it said last: no server at 10.0.0.1"), std::string::npos) << said;
    ::kill(run.pid(), SIGINT);
    EXPECT_EQ(run.wait_for_end(), 128 + SIGINT);
    EXPECT_EQ(run.output().find("waiting for"), run.output().rfind("waiting for")) << run.output();
  }
}

TEST_F(RunCommandTest, WhatTheControllerComplainedAboutStandsBehindTheRun) {
  RunningProgram run(command({"--set", "duration=1", "--controller", "echo link lost >&2; exec " SLEWLAB_BINARY_DIR "/bin/slewlab-controller"}));
  EXPECT_EQ(run.wait_for_end(), 0) << run.complaints();
  EXPECT_NE(run.output().find(": the controller said (" + (out_ / "controller.txt").string() + "):\n  link lost\n"), std::string::npos) << run.output();
}

TEST_F(RunCommandTest, ATypoInASidesOptionsComesBeforeWhatIsMissing) {
  for (const auto& [program, typo, meant] : {std::tuple{"slewlab-controller", "--stered", "--steered"}, std::tuple{"slewlab-plant", "--ste", "--set"}}) {
    RunningProgram side({std::string(SLEWLAB_BINARY_DIR "/bin/") + program, typo});
    EXPECT_EQ(side.wait_for_end(), 2);
    EXPECT_EQ(side.complaints().rfind(std::string(program) + ": '" + typo + "' is no option of it, expected '" + meant + "'", 0), 0u) << side.complaints();
  }
}

TEST_F(RunCommandTest, ASpeedWithoutAWallClockIsRefused) {
  for (std::vector<std::string> words : {std::vector{kSlewlab, std::string("run"), kScenario},
                                         {kPlant, "--scenario", kScenario, "--bus", "udpm://239.255.76.67:7667?ttl=0", "--log", out_.string()}}) {
    words.insert(words.end(), {"--speed", "2"});
    RunningProgram program(words);
    EXPECT_EQ(program.wait_for_end(), 2);
    EXPECT_NE(program.complaints().find("found --speed without --realtime, expected both or neither"), std::string::npos) << program.complaints();
  }
}

TEST_F(RunCommandTest, AnAddressThatIsNoBusIsAWrongCommand) {
  for (std::vector<std::string> words : {std::vector{kPlant, std::string("--scenario"), kScenario, std::string("--log"), out_.string()},
                                         {kController, "--config", SLEWLAB_SOURCE_DIR "/config/controllers/thesis.yaml", "--period-ms", "10"}}) {
    words.insert(words.end(), {"--bus", "udpm://127.0.0.1:7667"});
    RunningProgram program(words);
    EXPECT_EQ(program.wait_for_end(), 2);
    EXPECT_NE(program.complaints().find("127.0.0.1 is no multicast group"), std::string::npos) << program.complaints();
  }
}

TEST_F(RunCommandTest, TheProgramsOfASideTellTheirVersion) {
  RunningProgram all({kSlewlab, "--version"});
  EXPECT_EQ(all.wait_for_end(), 0);
  const std::string version = all.output().substr(all.output().find(' '), all.output().find('\n') - all.output().find(' '));
  for (const char* program : {"slewlab-controller", "slewlab-plant"}) {
    RunningProgram side({std::string(SLEWLAB_BINARY_DIR "/bin/") + program, "--version"});
    EXPECT_EQ(side.wait_for_end(), 0) << side.complaints();
    EXPECT_EQ(side.output(), program + version + "\n");
  }
}

TEST_F(RunCommandTest, AFileInTheFoldersPlaceIsAWrongCall) {
  const fs::path file = folder_.path() / "file";
  std::ofstream(file) << "mine";
  for (const auto& [out, found] : {std::pair{file, std::string(", which is a file")}, std::pair{file / "below", ", of which " + file.string() + " is a file"}}) {
    RunningProgram run({kSlewlab, "run", SLEWLAB_SOURCE_DIR "/config/scenarios/thesis_slew.yaml", "--out", out.string()});
    EXPECT_EQ(run.wait_for_end(), 2);
    EXPECT_EQ(run.complaints(), "--out: found '" + out.string() + "'" + found + ", expected the name of a folder, there or not\n");
  }
  EXPECT_EQ(contents(file), "mine");
}

TEST_F(RunCommandTest, TheResolvedConfigurationRunsAgainToTheSameBytes) {
  RunningProgram first(command({"--set", "duration=2", "--set", "crane.load.mass=20 t"}));
  ASSERT_EQ(first.wait_for_end(), 0) << first.complaints();
  const fs::path again = folder_.path() / "again";
  RunningProgram second({kSlewlab, "run", (out_ / "scenario.yaml").string(), "--out", again.string()});
  ASSERT_EQ(second.wait_for_end(), 0) << second.complaints();
  EXPECT_TRUE(contents(out_ / "run.lcmlog") == contents(again / "run.lcmlog"));
  EXPECT_EQ(contents(out_ / "crane.yaml"), contents(again / "crane.yaml"));
  // The override is in the copy, and counts: another configuration than the original's.
  RunningProgram original(command({"--set", "duration=2"}));
  const auto changed_hash = summary()["run"]["configuration_hash"];
  ASSERT_EQ(original.wait_for_end(), 0) << original.complaints();
  EXPECT_NE(summary()["run"]["configuration_hash"], changed_hash);
}

TEST_F(RunCommandTest, AKilledPlantIsNamedAndTakesTheControllerAlong) {
  RunningProgram run(long_command());
  const std::string started = run.wait_for_line("plant is process");
  ASSERT_NE(run.wait_for_line(advanced), "");
  ::kill(number_after(started, "plant is process "), SIGKILL);
  EXPECT_EQ(run.wait_for_end(), 1);
  wait_until_nothing_is_left();
  EXPECT_NE(run.complaints().find("the plant ended before its time: killed by signal 9"), std::string::npos)
      << run.complaints();
  EXPECT_EQ(summary()["outcome"], "failed");
  EXPECT_EQ(run.complaints().find(" s of simulated time"), std::string::npos) << "nobody knows how far it came: " << run.complaints();
  expect_partial_log();
}

TEST_F(RunCommandTest, AKilledControllerIsNamedAndTakesThePlantAlong) {
  RunningProgram run(long_command());
  const std::string started = run.wait_for_line("plant is process");
  ASSERT_NE(run.wait_for_line(advanced), "");
  ::kill(number_after(started, "controller is process "), SIGKILL);
  EXPECT_EQ(run.wait_for_end(), 1);
  wait_until_nothing_is_left();
  char when[64];
  std::snprintf(when, sizeof when, "(Killed) at %.1f s of simulated time", summary()["run"]["simulated_seconds"].get<double>());
  EXPECT_NE(run.complaints().find(std::string("the controller ended before its time: killed by signal 9 ") + when), std::string::npos) << run.complaints();
  expect_partial_log();
}

TEST_F(RunCommandTest, AControllerThatFailsIsToldWithItsLastWords) {
  RunningProgram run(long_command({"--controller", "echo the encoder is on fire >&2; exit 3"}));
  EXPECT_EQ(run.wait_for_end(), 1);
  wait_until_nothing_is_left();
  EXPECT_NE(run.complaints().find("the controller ended before its time: exit code 3"), std::string::npos);
  EXPECT_NE(run.complaints().find("the encoder is on fire"), std::string::npos) << run.complaints();
  EXPECT_EQ(contents(out_ / "controller.txt"), "the encoder is on fire\n");
}

TEST_F(RunCommandTest, AControllerThatLeavesTheRunQuietlyIsAFailureToo) {
  RunningProgram run(long_command({"--controller", "true"}));
  EXPECT_EQ(run.wait_for_end(), 1);
  EXPECT_NE(run.complaints().find("exit code 0"), std::string::npos) << run.complaints();
}

TEST_F(RunCommandTest, SignalsArePassedOnAndNothingStays) {
  for (const int number : {SIGINT, SIGTERM}) {
    RunningProgram run(long_command());
    ASSERT_NE(run.wait_for_line(advanced), "");
    ::kill(run.pid(), number);
    EXPECT_EQ(run.wait_for_end(), 128 + number);
    wait_until_nothing_is_left();
    EXPECT_EQ(summary()["outcome"], "interrupted");
    // The plant heard the signal and put its log in order.
    EXPECT_EQ(summary()["plant_end"], "exit code " + std::to_string(128 + number));
    expect_partial_log();
  }
}

// A thousand elements take the plant minutes to assemble, and took the launcher minutes more for its list of modes, in which
// it heard nothing: beyond this test's time limit.
TEST_F(RunCommandTest, ASignalEndsARunWhoseCraneIsStillBeingAssembled) {
  RunningProgram run(command({"--set", "crane.boom.elements=1000"}));
  ASSERT_NE(run.wait_for_line("plant is process"), "");
  ::kill(run.pid(), SIGTERM);
  EXPECT_EQ(run.wait_for_end(), 128 + SIGTERM);
  wait_until_nothing_is_left();
  EXPECT_EQ(summary()["outcome"], "interrupted");
  EXPECT_NE(run.complaints().find("warning: about 60 000 plant steps, some 100 seconds"), std::string::npos) << run.complaints();
  // There is no log yet, and none is promised.
  EXPECT_FALSE(fs::exists(out_ / "run.lcmlog.partial"));
  EXPECT_EQ(run.complaints().find("the log so far"), std::string::npos) << run.complaints();
}

// Once that nobody answers, and at the end for how long nobody did; asked again it has thousands of times by then.
TEST_F(RunCommandTest, APlantThatWaitsForAnAnswerSaysSoOnce) {
  RunningProgram plant({"/bin/sh", "-c", "exec \"$@\" 2>&1 >/dev/null", "sh", kPlant, "--scenario", kScenario,
                        "--bus", "udpm://239.255.76.67:7667?ttl=0", "--log", (folder_.path() / "run.lcmlog").string()});
  const std::string told = plant.wait_for_line("no answer to the ENCODER");
  EXPECT_NE(told.find("slewlab-plant: no answer to the ENCODER of 0.000 s since"), std::string::npos) << told;
  ::kill(plant.pid(), SIGTERM);
  plant.wait_for_end();
  const auto times = [&](const std::string& words) {
    int count = 0;
    for (std::size_t at = plant.output().find(words); at != std::string::npos; at = plant.output().find(words, at + 1)) ++count;
    return count;
  };
  EXPECT_EQ(times("no answer"), 1) << plant.output();
  EXPECT_EQ(times("that ENCODER was not answered until the run was stopped, after"), 1) << plant.output();
}

// What the plant refuses is told of the user's own file, also where the controller is the user's.
TEST_F(RunCommandTest, AnEffectThatIsUnknownIsToldWhereTheUserWroteIt) {
  const fs::path crane = folder_.path() / "mine.yaml";
  std::ofstream(crane) << "include: " SLEWLAB_SOURCE_DIR "/config/cranes/thesis.yaml\neffects:\n  - effect: dead_tim\n";
  for (const std::vector<std::string>& controller : {std::vector<std::string>{}, {"--controller", kController}}) {
    std::vector<std::string> more{"--set", "crane=" + crane.string()};
    more.insert(more.end(), controller.begin(), controller.end());
    RunningProgram run(command(more));
    EXPECT_EQ(run.wait_for_end(), 2);
    EXPECT_EQ(run.complaints().rfind(crane.string() + ":3:13: key 'effects.0.effect': found dead_tim", 0), 0u) << run.complaints();
  }
}

TEST_F(RunCommandTest, AStoppedSideDoesNotKeepTheRunFromEnding) {
  RunningProgram run(long_command());
  const std::string started = run.wait_for_line("plant is process");
  ASSERT_NE(run.wait_for_line(advanced), "");
  ::kill(number_after(started, "controller is process "), SIGSTOP);
  ::kill(number_after(started, "plant is process "), SIGSTOP);
  ::kill(run.pid(), SIGINT);
  EXPECT_EQ(run.wait_for_end(), 128 + SIGINT);
  wait_until_nothing_is_left();
  expect_partial_log();
}

TEST_F(RunCommandTest, AControllerThatDoesNotWantToEndIsKilled) {
  // It ignores SIGTERM and SIGINT; the second signal is the user's impatience.
  RunningProgram run(long_command({"--controller", "trap '' TERM INT; while :; do sleep 1000; done"}));
  ASSERT_NE(run.wait_for_line("plant is process"), "");
  ASSERT_NE(run.wait_for_line(" s simulated"), "");
  ::kill(run.pid(), SIGINT);
  ::kill(run.pid(), SIGTERM);
  EXPECT_GT(run.wait_for_end(), 128);
  wait_until_nothing_is_left();
}

TEST_F(RunCommandTest, AKilledLauncherLeavesNothing) {
  RunningProgram run(long_command());
  ASSERT_NE(run.wait_for_line(advanced), "");
  ::kill(run.pid(), SIGKILL);
  EXPECT_EQ(run.wait_for_end(), -SIGKILL);
  wait_until_nothing_is_left();  // plant, controller and watcher are this test's orphans now
  expect_partial_log();
  // What the run is was told to whoever looks on when it began, and that it is no complete one stays told.
  EXPECT_EQ(nlohmann::json::parse(contents(out_ / "run.json")).at("end"), "under way");
}

TEST_F(RunCommandTest, WhatTheControllerStartedGoesWithIt) {
  RunningProgram run(command({"--set", "duration=1", "--controller", "sleep 100000 & exec " + kController}));
  EXPECT_EQ(run.wait_for_end(), 0) << run.complaints();
  wait_until_nothing_is_left();
}

TEST_F(RunCommandTest, AKilledLauncherTakesAlongWhatTheControllerStarted) {
  RunningProgram run(long_command({"--controller", "sleep 100000 & exec " + kController}));
  ASSERT_NE(run.wait_for_line(advanced), "");
  ::kill(run.pid(), SIGKILL);
  run.wait_for_end();
  wait_until_nothing_is_left();
}

TEST_F(RunCommandTest, AControllerOfOnesOwnFindsItsBusAndItsConfiguration) {
  // Our controller again, but started by a shell, with nothing told but the environment.
  RunningProgram own(command({"--set", "duration=2", "--controller", kController}));
  ASSERT_EQ(own.wait_for_end(), 0) << own.complaints();
  const std::string with_own = contents(out_ / "run.lcmlog");
  RunningProgram usual(command({"--set", "duration=2"}));
  ASSERT_EQ(usual.wait_for_end(), 0) << usual.complaints();
  EXPECT_TRUE(contents(out_ / "run.lcmlog") == with_own);
}

TEST_F(RunCommandTest, AMistakeInTheConfigurationIsToldBeforeAnythingIsWritten) {
  RunningProgram run(command({"--set", "crane.load.mass=banana"}));
  EXPECT_EQ(run.wait_for_end(), 2);
  EXPECT_NE(run.complaints().find("banana"), std::string::npos) << run.complaints();
  EXPECT_FALSE(fs::exists(out_));
  RunningProgram no_file({kSlewlab, "run", "/nonexistent.yaml", "--out", out_.string()});
  EXPECT_EQ(no_file.wait_for_end(), 2);
  EXPECT_NE(no_file.complaints().find("/nonexistent.yaml"), std::string::npos) << no_file.complaints();
  RunningProgram no_option(command({"--nonsense"}));
  EXPECT_EQ(no_option.wait_for_end(), 2);
}

TEST_F(RunCommandTest, TwoRunsDoNotShareAFolder) {
  RunningProgram first(long_command());
  ASSERT_NE(first.wait_for_line(advanced), "");
  RunningProgram second(command());
  EXPECT_EQ(second.wait_for_end(), 1);
  EXPECT_NE(second.complaints().find("another run is writing into"), std::string::npos) << second.complaints();
  ::kill(first.pid(), SIGINT);
  EXPECT_EQ(first.wait_for_end(), 128 + SIGINT);
  expect_partial_log();
}

TEST_F(RunCommandTest, AControllerKilledAndStartedOnPurposeIsAnotherProcessAndTheSameRunTwice) {
  const std::string scenario = SLEWLAB_SOURCE_DIR "/config/scenarios/faults/controller_restarted.yaml";
  const fs::path other = folder_.path() / "other";
  for (const fs::path& out : {out_, other}) {
    RunningProgram run({kSlewlab, "run", scenario, "--out", out.string()});
    EXPECT_EQ(run.wait_for_end(), 0) << run.complaints();
  }
  EXPECT_EQ(summary()["run"]["drive"]["state"], "running");
  EXPECT_EQ(summary()["run"]["drive"]["faults"]["silence"], 1);
  EXPECT_TRUE(contents(out_ / "run.lcmlog") == contents(other / "run.lcmlog"));
  // The new controller counts its messages from 0 again.
  int first_messages = 0;
  msgs::LogReader reader(out_ / "run.lcmlog");
  msgs::LogEvent event;
  msgs::Torque torque;
  while (reader.next(event)) {
    if (event.channel != msgs::kTorqueChannel) continue;
    EXPECT_EQ(msgs::decode(event.data, torque), msgs::DecodeStatus::ok);
    first_messages += torque.alive_counter == 0;
  }
  EXPECT_EQ(first_messages, 2);
}

// What the clock says is the machine's affair (realtime_benchmark); that it is counted and told is ours.
TEST_F(RunCommandTest, AgainstTheWallClockEveryStepIsInTheHistogramsOfStatusAndSummary) {
  RunningProgram run(command({"--set", "duration=2", "--realtime", "--speed", "10"}));
  ASSERT_EQ(run.wait_for_end(), 0) << run.complaints();
  const auto timing = summary()["run"]["realtime"];
  EXPECT_EQ(timing["speed"], 10.0);
  EXPECT_NE(timing["permissions"].get<std::string>().find("SCHED_FIFO: "), std::string::npos);
  EXPECT_EQ(timing["log_events_left_out"], 0);
  EXPECT_EQ(nlohmann::json::parse(contents(out_ / "run.json"))["cycles"], 200);  // 2 s every 10 ms
  const msgs::RunLog log = msgs::read_run_logs(out_ / "run.lcmlog").runs.at(0);
  EXPECT_EQ(log.encoder.size(), 200u);
  const msgs::PlantStatus& status = log.plant_status.back();
  EXPECT_EQ(status.simulated_time, 2'000'000'000);
  EXPECT_EQ(std::accumulate(status.wakeup_latency.begin(), status.wakeup_latency.end(), std::int64_t{0}), 2000);
  // The last step is not done yet when its status goes out.
  EXPECT_EQ(std::accumulate(status.step_time.begin(), status.step_time.end(), std::int64_t{0}), 1999);
}

TEST_F(RunCommandTest, WhatTheScenarioExpectsIsJudgedAndTold) {
  const std::string scenario = SLEWLAB_SOURCE_DIR "/config/scenarios/faults/controller_killed.yaml";
  RunningProgram run({kSlewlab, "run", scenario, "--out", out_.string()});
  EXPECT_EQ(run.wait_for_end(), 0) << run.complaints();
  EXPECT_NE(run.output().find("everything under expect: of the scenario came about"), std::string::npos) << run.output();
  EXPECT_EQ(summary()["broken_expectations"], nlohmann::json::array());

  RunningProgram other({kSlewlab, "run", scenario, "--out", out_.string(), "--set", "expect.drive_state=running"});
  EXPECT_EQ(other.wait_for_end(), 1);
  const std::string broken = "drive state at the end: found braked, expected running";
  EXPECT_NE(other.complaints().find("not as expected: " + broken), std::string::npos) << other.complaints();
  EXPECT_EQ(summary()["broken_expectations"], nlohmann::json::array({broken}));
  EXPECT_EQ(summary()["outcome"], "complete");
}

// The process itself stands still, as the kernel says, and the drive hears nothing meanwhile.
TEST_F(RunCommandTest, AgainstTheWallClockAControllerStoppedOnPurposeIsAStoppedProcess) {
  const std::string scenario = SLEWLAB_SOURCE_DIR "/config/scenarios/faults/controller_stopped.yaml";
  RunningProgram run({kSlewlab, "run", scenario, "--out", out_.string(), "--progress", "lines", "--realtime", "--speed",
                      "10", "--set", "duration=13"});
  const std::string started = run.wait_for_line("plant is process");
  const std::string stat = "/proc/" + std::to_string(number_after(started, "controller is process ")) + "/stat";
  char state = '?';
  while (state != 'T' && fs::exists(stat)) {
    const std::string text = contents(stat);
    const std::size_t name_end = text.rfind(") ");
    if (name_end != std::string::npos) state = text[name_end + 2];
  }
  EXPECT_EQ(state, 'T') << "it was never stopped";
  EXPECT_EQ(run.wait_for_end(), 0) << run.complaints();
  EXPECT_GE(summary()["run"]["drive"]["faults"]["silence"], 1);
  EXPECT_EQ(summary()["run"]["drive"]["state"], "braked");
  EXPECT_GE(summary()["run"]["drive"]["faults"]["wrong_sequence"], 1) << "nothing was answered late";
}

TEST_F(RunCommandTest, TwoRunsSideBySideDoNotHearEachOther) {
  RunningProgram first(command({"--set", "duration=20"}));
  const fs::path other = folder_.path() / "other";
  RunningProgram second({kSlewlab, "run", kScenario, "--out", other.string(), "--set", "duration=20"});
  EXPECT_EQ(first.wait_for_end(), 0);
  EXPECT_EQ(second.wait_for_end(), 0);
  EXPECT_EQ(summary()["run"]["wrong_answers"], 0);
  EXPECT_TRUE(contents(out_ / "run.lcmlog") == contents(other / "run.lcmlog"));
}

TEST_F(RunCommandTest, WithoutAMulticastRouteItFindsANetworkOfItsOwn) {
  std::vector<std::string> bare{"unshare", "--net"};
  const auto inner = command({"--set", "duration=1"});
  bare.insert(bare.end(), inner.begin(), inner.end());
  RunningProgram run(bare);
  EXPECT_EQ(run.wait_for_end(), 0) << run.complaints();
  EXPECT_EQ(summary()["network"], "private");
}

}  // namespace
}  // namespace slewlab::tools
