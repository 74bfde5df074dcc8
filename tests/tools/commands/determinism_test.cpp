// Two lockstep runs give the same log byte for byte, whatever the machine does meanwhile: one core busy, or either
// process stopped for two seconds in mid-run. Each test compares with the same undisturbed run.

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/msgs/temporary_folder.h"
#include "tests/tools/running_program.h"

namespace slewlab::tools {
namespace {

namespace fs = std::filesystem;

class DeterminismTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    calm_ = new std::string;
    DeterminismTest probe_run;
    RunningProgram run(probe_run.command());
    ASSERT_EQ(run.wait_for_end(), 0) << run.complaints();
    *calm_ = probe_run.log();
    ASSERT_GT(calm_->size(), 1'000'000u);
  }
  static void TearDownTestSuite() { delete calm_; }
  void TestBody() override {}

  std::vector<std::string> command() const {
    const std::string slewlab = SLEWLAB_BINARY_DIR "/bin/slewlab", scenario = SLEWLAB_SOURCE_DIR "/config/scenarios/thesis_slew.yaml";
    return {slewlab, "run", scenario, "--out", folder_.path().string(), "--progress", "lines", "--set", "duration=200"};
  }
  std::string log() const {
    std::ifstream file(folder_.path() / "run.lcmlog", std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  // In mid-run: simulated time has begun to pass.
  static bool under_way(const std::string& line) {
    return line.find(" s simulated") != std::string::npos && line.find(": 0.0 of") == std::string::npos;
  }
  std::int64_t resends() const {
    std::ifstream file(folder_.path() / "summary.json");
    return nlohmann::json::parse(file)["run"]["resends"];
  }

  TemporaryFolder folder_;
  static std::string* calm_;
};

std::string* DeterminismTest::calm_ = nullptr;

TEST_F(DeterminismTest, ASecondRunGivesTheSameBytes) {
  RunningProgram run(command());
  ASSERT_EQ(run.wait_for_end(), 0) << run.complaints();
  EXPECT_TRUE(log() == *calm_);
}

TEST_F(DeterminismTest, WithOneCoreLoaded) {
  std::atomic<bool> done{false};
  std::thread load([&] {
    while (!done) {
    }
  });
  RunningProgram run(command());
  const int code = run.wait_for_end();
  done = true;
  load.join();
  ASSERT_EQ(code, 0) << run.complaints();
  EXPECT_TRUE(log() == *calm_);
}

TEST_F(DeterminismTest, WithTheControllerStoppedForTwoSeconds) {
  RunningProgram run(command());
  const pid_t controller = number_after(run.wait_for_line("plant is process"), "controller is process ");
  ASSERT_NE(run.wait_for_line(under_way), "");
  ASSERT_EQ(::kill(controller, SIGSTOP), 0);
  // The launcher says this after two seconds without progress.
  ASSERT_NE(run.wait_for_line("waiting for the controller"), "") << "the run was over before it could be stopped";
  ::kill(controller, SIGCONT);
  ASSERT_EQ(run.wait_for_end(), 0) << run.complaints();
  EXPECT_GT(resends(), 0);
  EXPECT_TRUE(log() == *calm_);
}

TEST_F(DeterminismTest, WithThePlantStoppedForTwoSeconds) {
  RunningProgram run(command());
  const pid_t plant = number_after(run.wait_for_line("plant is process"), "plant is process ");
  ASSERT_NE(run.wait_for_line(under_way), "");
  ASSERT_EQ(::kill(plant, SIGSTOP), 0);
  ::usleep(2'000'000);  // the disturbance itself: nothing is waited for
  ::kill(plant, SIGCONT);
  ASSERT_EQ(run.wait_for_end(), 0) << run.complaints();
  EXPECT_TRUE(log() == *calm_);
}

}  // namespace
}  // namespace slewlab::tools
