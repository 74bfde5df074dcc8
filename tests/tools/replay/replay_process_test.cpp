// slewlab replay --controller: a recorded run against a controller's process, over LCM.

#include <gtest/gtest.h>

#include "tests/msgs/temporary_folder.h"
#include "tests/tools/running_program.h"

namespace slewlab::tools {
namespace {

const std::string kSlewlab = SLEWLAB_BINARY_DIR "/bin/slewlab";
const std::string kController = SLEWLAB_BINARY_DIR "/bin/slewlab-controller";

TEST(ReplayProcess, NewControllerCodeIsComparedWithTheRecord) {
  const TemporaryFolder folder;
  const std::string out = (folder.path() / "out").string();
  RunningProgram run({kSlewlab, "run", SLEWLAB_SOURCE_DIR "/config/scenarios/thesis_slew.yaml", "--out", out,
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

}  // namespace
}  // namespace slewlab::tools
