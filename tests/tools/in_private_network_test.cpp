// tools/in-private-network as a user calls it.

#include <gtest/gtest.h>

#include <csignal>

#include "tests/tools/running_program.h"

namespace slewlab {
namespace {

const std::string kWrapper = SLEWLAB_SOURCE_DIR "/tools/in-private-network";

TEST(InPrivateNetwork, HoldsALoopbackWithAMulticastRouteAndNothingElse) {
  RunningProgram run({kWrapper, "sh", "-c", "ip -o link | wc -l; ip link show lo; ip route"});
  EXPECT_EQ(run.wait_for_end(), 0) << run.complaints();
  EXPECT_EQ(run.output().substr(0, 2), "1\n");
  EXPECT_NE(run.output().find("LOOPBACK,MULTICAST,UP"), std::string::npos) << run.output();
  EXPECT_NE(run.output().find("224.0.0.0/4 dev lo"), std::string::npos) << run.output();
  EXPECT_NE(run.complaints().find("unshare"), std::string::npos) << "it does not say which way it took";
}

TEST(InPrivateNetwork, PassesArgumentsAndExitCodeOn) {
  RunningProgram run({kWrapper, "sh", "-c", "printf '%s\\n' \"$1\"; exit 7", "sh", "two  words $HOME"});
  EXPECT_EQ(run.wait_for_end(), 7);
  EXPECT_EQ(run.output(), "two  words $HOME\n");
}

TEST(InPrivateNetwork, SignalsReachTheCommand) {
  RunningProgram run({kWrapper, "sh", "-c", "trap 'echo heard; exit 5' TERM; echo ready; while :; do sleep 0.01; done"});
  ASSERT_EQ(run.wait_for_line("ready"), "ready");
  ::kill(run.pid(), SIGTERM);
  EXPECT_EQ(run.wait_for_line("heard"), "heard");
  EXPECT_EQ(run.wait_for_end(), 5);
}

TEST(InPrivateNetwork, WithoutACommandItSaysHowItIsUsed) {
  RunningProgram run({kWrapper});
  EXPECT_EQ(run.wait_for_end(), 2);
  EXPECT_NE(run.complaints().find("usage"), std::string::npos);
}

}  // namespace
}  // namespace slewlab
