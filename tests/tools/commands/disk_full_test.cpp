// A disk that is full, over the whole chain: a tmpfs of a few hundred kilobytes, which this test mounts in a mount
// namespace of its own. The error names the file and the reason, the log so far is intact, nothing else is half
// written, nothing runs on.

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "msgs/log_reader.h"
#include "msgs/run_log.h"
#include "tests/msgs/temporary_folder.h"
#include "tests/tools/running_program.h"

namespace slewlab::tools {
namespace {

namespace fs = std::filesystem;

const std::string kSlewlab = SLEWLAB_BINARY_DIR "/bin/slewlab";
const std::string kScenario = SLEWLAB_SOURCE_DIR "/config/scenarios/thesis_slew.yaml";
const std::string kFull = "No space left on device";

class DiskFullTest : public testing::Test {
 protected:
  void SetUp() override {
    ::setenv("SLEWLAB_QUIET_NETWORK", "1", 1);
    // The mounts of the test's own process; what it starts inherits them, nobody else sees them.
    if (::unshare(CLONE_NEWNS) != 0 || ::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0) {
      GTEST_SKIP() << "no mount namespace of one's own here (" << std::strerror(errno) << "), so no small disk to fill";
    }
    fs::create_directory(disk_);
  }
  void TearDown() override { ::umount2(disk_.c_str(), MNT_DETACH); }

  void mount_disk(const char* options) {
    ASSERT_EQ(::mount("tmpfs", disk_.c_str(), "tmpfs", 0, options), 0) << std::strerror(errno);
  }
  // Leaves `bytes` free on the disk.
  void fill_but(std::uintmax_t bytes) {
    const std::uintmax_t free = fs::space(disk_).available;
    ASSERT_GT(free, bytes);
    std::ofstream file(disk_ / "ballast", std::ios::binary);
    const std::string block(4096, 'x');
    for (std::uintmax_t written = 0; written + block.size() <= free - bytes; written += block.size()) file << block;
  }
  std::vector<std::string> files_on_disk() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(disk_)) {
      if (entry.is_regular_file()) names.push_back(fs::relative(entry.path(), disk_).string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }

  // The log so far: whole events without a gap, and nothing behind them.
  void expect_log_intact(const fs::path& partial, std::int64_t at_least) const {
    ASSERT_TRUE(fs::exists(partial));
    msgs::LogReader reader(partial);
    msgs::LogEvent event;
    std::int64_t events = 0;
    while (reader.next(event)) EXPECT_EQ(event.number, events++);
    EXPECT_GE(events, at_least);
    EXPECT_TRUE(msgs::describe(reader.damage()).empty()) << msgs::describe(reader.damage()).front();
    const msgs::RunLogs logs = msgs::read_run_logs(partial);
    EXPECT_EQ(logs.runs.size(), 1u);
  }

  void expect_run_ends_well(const std::vector<std::string>& more) {
    mount_disk("size=600k");
    std::vector<std::string> command{kSlewlab, "run", kScenario, "--out", (disk_ / "out").string()};
    command.insert(command.end(), more.begin(), more.end());
    RunningProgram run(command);
    EXPECT_EQ(run.wait_for_end(), 1);
    wait_until_nothing_is_left();
    EXPECT_NE(run.complaints().find((disk_ / "out/run.lcmlog.partial").string() + ": " + kFull), std::string::npos)
        << run.complaints();
    EXPECT_NE(run.complaints().find("the plant ended before its time"), std::string::npos) << run.complaints();
    EXPECT_FALSE(fs::exists(disk_ / "out/run.lcmlog")) << "a log that lost events passes for a complete one";
    expect_log_intact(disk_ / "out/run.lcmlog.partial", 1000);
    // What else there is, is whole: nothing waits under another name to be finished.
    for (const std::string& name : files_on_disk()) EXPECT_EQ(name.find(".half"), std::string::npos) << name;
  }

  TemporaryFolder folder_;
  fs::path disk_ = folder_.path() / "disk";
};

TEST_F(DiskFullTest, ALockstepRunEndsWithTheReasonAndKeepsItsLogSoFar) {
  expect_run_ends_well({"--set", "duration=1000"});
}

TEST_F(DiskFullTest, ARunAgainstTheWallClockDoesSoToo) {
  expect_run_ends_well({"--set", "duration=1000", "--realtime", "--speed", "20"});
}

TEST_F(DiskFullTest, WithNoRoomForTheConfigurationNothingIsStarted) {
  mount_disk("size=64k");
  fill_but(0);
  RunningProgram run({kSlewlab, "run", kScenario, "--out", (disk_ / "out").string()});
  EXPECT_EQ(run.wait_for_end(), 1);
  EXPECT_EQ(run.output(), "");
  EXPECT_NE(run.complaints().find(kFull), std::string::npos) << run.complaints();
  EXPECT_EQ(files_on_disk(), std::vector<std::string>{"ballast"});
}

// What is made of logs and data: an error that names the file, and no file.
class DiskFullForOutputsTest : public DiskFullTest {
 protected:
  void SetUp() override {
    DiskFullTest::SetUp();
    if (IsSkipped()) return;
    if (!fs::exists(SLEWLAB_SOURCE_DIR "/.venv/bin/python")) GTEST_SKIP() << "no .venv here (tools/setup makes it)";
    RunningProgram run({kSlewlab, "run", kScenario, "--out", run_.string(), "--set", "duration=20"});
    ASSERT_EQ(run.wait_for_end(), 0) << run.complaints();
    mount_disk("size=256k");
  }
  void expect_refused(const std::vector<std::string>& arguments, const fs::path& out) {
    std::vector<std::string> command{kSlewlab};
    command.insert(command.end(), arguments.begin(), arguments.end());
    RunningProgram program(command);
    EXPECT_EQ(program.wait_for_end(), 1) << arguments.front();
    EXPECT_NE(program.complaints().find(out.string()), std::string::npos) << program.complaints();
    EXPECT_NE(program.complaints().find(kFull), std::string::npos) << program.complaints();
    EXPECT_EQ(files_on_disk(), std::vector<std::string>{}) << arguments.front();
  }
  fs::path run_ = folder_.path() / "run";
};

TEST_F(DiskFullForOutputsTest, Report) {
  expect_refused({"report", run_.string(), "--out", (disk_ / "report.html").string()}, disk_ / "report.html");
}

TEST_F(DiskFullForOutputsTest, Export) {
  for (const char* format : {"csv", "parquet", "mcap"}) {
    const fs::path out = disk_ / format;
    expect_refused({"export", run_.string(), "--format", format, "--out", out.string()}, out);
  }
}

TEST_F(DiskFullForOutputsTest, Import) {
  const fs::path map = folder_.path() / "map.yaml";
  const fs::path data = folder_.path() / "data.csv";
  std::ofstream(map) << "kind: import_map\ntime: {column: row, unit: ms}\n"
                        "shaft_position: [{column: angle, unit: rad}]\nshaft_speed: [{derive: central_difference}]\n"
                        "motor_torque: [{column: torque, unit: N m}]\n";
  std::ofstream rows(data);
  rows << "row,angle,torque\n";
  for (int i = 0; i < 10'000; ++i) rows << i << ',' << i << ",1\n";
  rows.close();
  const fs::path out = disk_ / "site.lcmlog";
  expect_refused({"import", "--map", map.string(), data.string(), "--out", out.string()}, out);
}

// The page and all that stands beside it: half a diagnosis is none.
TEST_F(DiskFullForOutputsTest, Diagnosis) {
  const std::string config = SLEWLAB_SOURCE_DIR "/config/";
  const fs::path log = folder_.path() / "axis";
  RunningProgram run({kSlewlab, "run", config + "scenarios/example_axis.yaml", "--out", log.string()});
  ASSERT_EQ(run.wait_for_end(), 0) << run.complaints();
  fill_but(8192);
  const fs::path out = disk_ / "diagnosis";
  RunningProgram diagnose({kSlewlab, "diagnose", "--axis", config + "axes/example_axis.yaml", "--log", log.string(), "--out", out.string()});
  EXPECT_EQ(diagnose.wait_for_end(), 1) << diagnose.output();
  EXPECT_NE(diagnose.complaints().find(kFull), std::string::npos) << diagnose.complaints();
  EXPECT_EQ(diagnose.complaints().find("Traceback"), std::string::npos) << diagnose.complaints();
  EXPECT_EQ(files_on_disk(), std::vector<std::string>{"ballast"});
}

TEST_F(DiskFullForOutputsTest, WithheldCases) {
  const fs::path out = disk_ / "set";
  RunningProgram make({kSlewlab, "withhold", "make", "--cases", "1", "--seed", "1", "--out", out.string()});
  EXPECT_EQ(make.wait_for_end(), 1) << make.output();
  EXPECT_NE(make.complaints().find(out.string()), std::string::npos) << make.complaints();
  for (const std::string& name : files_on_disk()) {
    EXPECT_FALSE(name.ends_with(".lcmlog")) << name << " passes for a complete log";
    EXPECT_EQ(name.find("answers.json"), std::string::npos) << "answers without cases";
  }
}

}  // namespace
}  // namespace slewlab::tools
