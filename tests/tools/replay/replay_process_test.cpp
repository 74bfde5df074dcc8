// slewlab replay --controller: a recorded run against a controller's process, over LCM.

#include <gtest/gtest.h>
#include <signal.h>

#include "tests/msgs/temporary_folder.h"
#include "tests/tools/running_program.h"

namespace slewlab::tools {
namespace {

const std::string kSlewlab = SLEWLAB_BINARY_DIR "/bin/slewlab";
const std::string kController = SLEWLAB_BINARY_DIR "/bin/slewlab-controller";
const std::string kScenario = SLEWLAB_SOURCE_DIR "/config/scenarios/thesis_slew.yaml";

TEST(ReplayProcess, NewControllerCodeIsComparedWithTheRecord) {
  const TemporaryFolder folder;
  const std::string out = (folder.path() / "out").string();
  RunningProgram run({kSlewlab, "run", kScenario, "--out", out,
                      "--progress", "none", "--set", "duration=7"});
  ASSERT_EQ(run.wait_for_end(), 0) << run.complaints();

  RunningProgram same({kSlewlab, "replay", out, "--controller", kController});
  EXPECT_EQ(same.wait_for_end(), 0) << same.output() << same.complaints();
  EXPECT_NE(same.output().find("TORQUE                700 compared, all identical to the bit"), std::string::npos)
      << same.output();

  // The ramp begins at 5 s; a flatter one cannot show before.
  const std::string changed = kController + " --set ramp.acceleration_time=6";
  RunningProgram other({kSlewlab, "replay", out, "--controller", changed});
  EXPECT_EQ(other.wait_for_end(), 1);
  EXPECT_NE(other.output().find("first difference: at 5.0"), std::string::npos) << other.output();
  EXPECT_NE(other.output().find("CONTROLLER_STATE.ramped_speed [rad/s]"), std::string::npos) << other.output();

  // A replay is as long as its log; a controller of one's own reads its own file.
  for (const auto& [more, key] : {std::pair{std::vector<std::string>{}, "duration=2"}, std::pair{std::vector<std::string>{"--controller", kController}, "crane.load.mass=3t"},
                                  std::pair{std::vector<std::string>{}, "operator.0.speed_request=0.5"}}) {
    std::vector<std::string> words{kSlewlab, "replay", out, "--set", key};
    words.insert(words.end(), more.begin(), more.end());
    RunningProgram ignored(words);
    EXPECT_EQ(ignored.wait_for_end(), 2) << key;
    EXPECT_NE(ignored.complaints().find("found a setting that changes nothing here, expected "), std::string::npos) << ignored.complaints();
  }
  RunningProgram heavier({kSlewlab, "replay", out, "--set", "crane.load.mass=3t"});
  EXPECT_EQ(heavier.wait_for_end(), 1) << heavier.output() << heavier.complaints();

  RunningProgram tolerated({kSlewlab, "replay", out, "--controller", changed, "--tolerance", "TORQUE.motor_torque=1000",
                            "--tolerance", "CONTROLLER_STATE.ramped_speed=1", "--tolerance",
                            "CONTROLLER_STATE.average_torque=1000", "--tolerance", "CONTROLLER_STATE.offset_torque=1000",
                            "--tolerance", "CONTROLLER_STATE.proportional_torque=1000", "--tolerance",
                            "CONTROLLER_STATE.integral_torque=1000"});
  EXPECT_EQ(tolerated.wait_for_end(), 0) << tolerated.output();

  RunningProgram dead({kSlewlab, "replay", out, "--controller", "echo no licence >&2; exit 4"});
  EXPECT_EQ(dead.wait_for_end(), 1);
  EXPECT_NE(dead.complaints().find("exit code 4"), std::string::npos) << dead.complaints();
  EXPECT_NE(dead.complaints().find("no licence"), std::string::npos) << dead.complaints();
  wait_until_nothing_is_left();
}

// What arrived late, twice, in another order or not at all arrives so again; what failed on the crane fails again.
TEST(ReplayProcess, RunsWithFaultsOnPurposeAreIdenticalToTheBit) {
  const TemporaryFolder folder;
  const std::string out = (folder.path() / "out").string();
  for (const char* name : {"controller_restarted", "torque_lost_for_a_while", "torque_reordered", "torque_duplicated",
                           "encoder_noisy", "main_power_lost"}) {
    const std::string scenario = std::string(SLEWLAB_SOURCE_DIR "/config/scenarios/faults/") + name + ".yaml";
    RunningProgram run({kSlewlab, "run", scenario, "--out", out, "--progress", "none"});
    ASSERT_EQ(run.wait_for_end(), 0) << run.complaints();
    RunningProgram replay({kSlewlab, "replay", out});
    EXPECT_EQ(replay.wait_for_end(), 0) << name << '\n' << replay.output() << replay.complaints();
    EXPECT_NE(replay.output().find("SENSORS              6001 compared, all identical"), std::string::npos) << replay.output();
  }
}

// What the controller answers hangs on nothing but what it was asked, on whatever clock. When a TORQUE acted the log does
// not tell; so of the plant's half only that it is compared.
TEST(ReplayProcess, ARealRunAgainstTheWallClockAndItsLcmLoggerLogReplay) {
  const TemporaryFolder folder;
  const std::string out = (folder.path() / "out").string();
  const std::string logger_log = (folder.path() / "logger.lcmlog").string();
  RunningProgram run({kSlewlab, "run", kScenario, "--out", out,
                      "--progress", "lines", "--realtime", "--speed", "4", "--set", "duration=8"});
  const std::string started = run.wait_for_line("udpm://");
  RunningProgram logger({"lcm-logger", "--quiet", "--lcm-url=" + started.substr(started.find("udpm://")), logger_log});
  ASSERT_EQ(run.wait_for_end(), 0) << run.complaints();
  ::kill(logger.pid(), SIGINT);
  logger.wait_for_end();

  const std::string controllers_half = "controller, fed with the recorded ENCODER and OPERATOR";
  RunningProgram own({kSlewlab, "replay", out});
  EXPECT_LE(own.wait_for_end(), 1) << own.complaints();
  EXPECT_NE(own.output().find("ENCODER               800 compared"), std::string::npos) << own.output();
  ASSERT_NE(own.output().find(controllers_half), std::string::npos) << own.output();
  const std::string own_half = own.output().substr(own.output().find(controllers_half));
  EXPECT_NE(own_half.find("    identical to the bit"), std::string::npos) << own_half;

  // It came up when the run was under way, and hears of SENSORS and TRUTH only what goes out live.
  RunningProgram theirs({kSlewlab, "replay", logger_log, "--scenario", out + "/scenario.yaml"});
  EXPECT_LE(theirs.wait_for_end(), 1) << theirs.complaints();
  EXPECT_NE(theirs.output().find("messages are missing"), std::string::npos) << theirs.output();
  ASSERT_NE(theirs.output().find(controllers_half), std::string::npos) << theirs.output();
  const std::string their_half = theirs.output().substr(theirs.output().find(controllers_half));
  EXPECT_NE(their_half.find("TORQUE "), std::string::npos) << their_half;
}

}  // namespace
}  // namespace slewlab::tools
