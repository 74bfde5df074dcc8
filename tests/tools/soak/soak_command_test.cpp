// `slewlab soak` as a person calls it: interrupted by Ctrl-C it says so and goes on; what it prints on a failure is a
// command that fails in the same way.

#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>
#include <sstream>

#include "tests/msgs/file_contents.h"
#include "tests/msgs/temporary_folder.h"
#include "tests/tools/running_program.h"

namespace slewlab {
namespace {

namespace fs = std::filesystem;

const std::string kSlewlab = SLEWLAB_BINARY_DIR "/bin/slewlab";

int count_of(const std::string& text, const std::string& part) {
  int count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

TEST(SoakCommand, GoesOnAfterCtrlC) {
  const TemporaryFolder folder;
  const std::vector<std::string> command{kSlewlab, "soak", "--hours", "0.2", "--seed", "2", "--jobs", "2", "--faults",
                                         "--set", "task.duration=36", "--out", folder.path() / "out"};
  int first_result = 0;
  {
    RunningProgram first(command);
    ASSERT_FALSE(first.wait_for_line("of 20 tasks").empty());
    // Ctrl-C reaches the launcher; its workers are told by it.
    ::kill(first.pid(), SIGINT);
    first_result = first.wait_for_end();
    if (first_result != 0) {
      EXPECT_EQ(first_result, 128 + SIGINT);
      EXPECT_NE(first.output().find("the same command goes on from here"), std::string::npos) << first.output();
    }
  }
  wait_until_nothing_is_left();
  RunningProgram second(command);
  EXPECT_EQ(second.wait_for_end(), 0) << second.output() << second.complaints();
  EXPECT_NE(second.output().find("complete: 0.20 simulated hours in 20 tasks, 0 failed"), std::string::npos)
      << second.output();
  EXPECT_EQ(count_of(contents(folder.path() / "out/journal.jsonl"), "\"outcome\":\"good\""), 20);
  wait_until_nothing_is_left();
}

// kill -9 leaves no worker behind, and nothing that the next session trips over.
TEST(SoakCommand, GoesOnAfterKill) {
  const TemporaryFolder folder;
  const std::vector<std::string> command{kSlewlab, "soak", "--hours", "0.1", "--seed", "2", "--jobs", "2", "--set",
                                         "task.duration=36", "--out", folder.path() / "out"};
  {
    RunningProgram first(command);
    ASSERT_FALSE(first.wait_for_line("of 10 tasks").empty());
    ::kill(first.pid(), SIGKILL);
    first.wait_for_end();
  }
  wait_until_nothing_is_left();
  RunningProgram second(command);
  EXPECT_EQ(second.wait_for_end(), 0) << second.output() << second.complaints();
  EXPECT_EQ(count_of(contents(folder.path() / "out/journal.jsonl"), "\"outcome\":\"good\""), 10);
  EXPECT_FALSE(fs::exists(folder.path() / "out/running"));
}

// A second soak in the same folder is refused, and so is a full disk, each in one line.
TEST(SoakCommand, SaysWhyItCannotGoOn) {
  const TemporaryFolder folder;
  const std::vector<std::string> command{kSlewlab, "soak", "--hours", "1", "--seed", "2", "--out", folder.path() / "out"};
  RunningProgram first(command);
  ASSERT_FALSE(first.wait_for_line("of 30 tasks").empty());
  RunningProgram second(command);
  EXPECT_EQ(second.wait_for_end(), 1);
  EXPECT_NE(second.complaints().find("another soak is writing"), std::string::npos) << second.complaints();
  ::kill(first.pid(), SIGTERM);
  EXPECT_EQ(first.wait_for_end(), 128 + SIGTERM);

  // Files of at most 512 kB: a task's log does not fit.
  RunningProgram full({"/bin/sh", "-c", "ulimit -f 1024; trap '' XFSZ; exec \"$@\"", "sh", kSlewlab, "soak", "--hours", "0.1",
                       "--seed", "2", "--out", folder.path() / "full"});
  EXPECT_EQ(full.wait_for_end(), 1);
  EXPECT_NE(full.complaints().find("run.lcmlog.partial: File too large"), std::string::npos) << full.complaints();
  EXPECT_EQ(count_of(full.complaints(), "\n"), 1) << full.complaints();
}

TEST(SoakCommand, TheCommandOfAFailureFailsInTheSameWay) {
  const TemporaryFolder folder;
  RunningProgram soak({kSlewlab, "soak", "--hours", "0.005", "--seed", "2", "--set", "task.duration=18", "--set",
                       "limits.house_speed=0.0001", "--out", folder.path() / "out"});
  EXPECT_EQ(soak.wait_for_end(), 1) << soak.complaints();
  const std::string text = contents(folder.path() / "out/failures/task-000000/failure.txt");
  const std::string mark = "again: slewlab ";
  ASSERT_NE(text.find(mark), std::string::npos) << text;
  std::istringstream words(text.substr(text.find(mark) + mark.size()));
  std::vector<std::string> command{kSlewlab};
  for (std::string word; words >> word;) command.push_back(word);
  command.insert(command.end(), {"--out", folder.path() / "again"});
  RunningProgram again(command);
  EXPECT_EQ(again.wait_for_end(), 1) << again.complaints();
  EXPECT_EQ(contents(folder.path() / "again/failure.txt"), text);
  EXPECT_TRUE(contents(folder.path() / "again/run.lcmlog") == contents(folder.path() / "out/failures/task-000000/run.lcmlog"));
}

// Two processes over LCM write the bytes that the soak wrote in one: what it finds holds for the real thing, and what it
// keeps can be run again as any scenario can. Task 9 loses a motor group, lies about an encoder and corrupts ENCODER.
TEST(SoakCommand, ATaskIsTheSameRunOverTheWire) {
  const TemporaryFolder folder;
  RunningProgram soak({kSlewlab, "soak", "--seed", "4", "--faults", "--task", "9", "--set", "task.duration=60", "--out",
                       folder.path() / "soak"});
  ASSERT_EQ(soak.wait_for_end(), 0) << soak.output() << soak.complaints();
  RunningProgram run({kSlewlab, "run", folder.path() / "soak/scenario.yaml", "--out", folder.path() / "run", "--progress",
                      "none"});
  ASSERT_EQ(run.wait_for_end(), 0) << run.complaints();
  EXPECT_TRUE(contents(folder.path() / "soak/run.lcmlog") == contents(folder.path() / "run/run.lcmlog"));
}

TEST(SoakCommand, AWrongCallIsToldInOneLine) {
  const auto call = [](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {kSlewlab, "soak", "--seed", "1"});
    RunningProgram program(arguments);
    EXPECT_EQ(program.wait_for_end(), 2);
    return program.output() + program.complaints();
  };
  EXPECT_NE(call({}).find("--hours or --task"), std::string::npos);
  EXPECT_NE(call({"--task", "x"}).find("a task's number"), std::string::npos);
  EXPECT_NE(call({"--hours", "1", "--set", "limits.sidelead=-1"}).find("limits.sidelead"), std::string::npos);
}

}  // namespace
}  // namespace slewlab
