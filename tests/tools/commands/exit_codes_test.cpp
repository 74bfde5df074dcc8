// A wrong command line, or a file that it names, ends every command with exit code 2, and whatever lies where it was to write stays
// (docs/command_line.md). Of the commands of the Python side: exit_codes_test.py.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/msgs/file_contents.h"
#include "tests/msgs/temporary_folder.h"
#include "tests/tools/running_program.h"

namespace slewlab::tools {
namespace {

namespace fs = std::filesystem;

const std::string kSlewlab = SLEWLAB_BINARY_DIR "/bin/slewlab";
const std::string kConfig = SLEWLAB_SOURCE_DIR "/config/";
const std::string kCrane = kConfig + "cranes/thesis.yaml", kScenario = kConfig + "scenarios/thesis_slew.yaml";

class ExitCodes : public testing::Test {
 protected:
  ExitCodes() {
    std::ofstream(file_) << "mine";
    fs::create_directories(below_);
    std::ofstream(below_ + "/thesis.txt") << "mine";
  }

  void expect_refused(const std::vector<std::string>& words, const std::string& said) const {
    std::vector<std::string> all{kSlewlab};
    all.insert(all.end(), words.begin(), words.end());
    RunningProgram program(all);
    EXPECT_EQ(program.wait_for_end(), 2) << words.front() << ": " << program.complaints();
    EXPECT_NE(program.complaints().find(said), std::string::npos) << words.front() << ": " << program.complaints();
  }

  const TemporaryFolder folder_;
  const std::string file_ = (folder_.path() / "file").string(), below_ = (folder_.path() / "folder").string(), out_ = (folder_.path() / "out").string();
};

TEST_F(ExitCodes, AFileThatIsNotThereOrOfAnotherKind) {
  for (const std::string& log : {std::string("/nowhere/run.lcmlog"), file_}) {
    expect_refused({"replay", log}, log);
    expect_refused({"simulate", kCrane, log, "--out", out_}, log);
    expect_refused({"cut", log, "--out", out_}, log);
    expect_refused({"diagnose", "--crane", kCrane, "--log", log, "--out", out_}, log);
  }
  for (const std::string& file : {std::string("/nowhere.yaml"), below_}) {
    expect_refused({"check", kCrane, file}, "FILE: found '" + file + "', expected the name of a file that is there");
  }
  expect_refused({"modes", below_}, "'" + below_ + "', which is a folder, expected the name of a readable file");
  expect_refused({"accept", "/nowhere"}, "/nowhere");
  expect_refused({"withhold", "make", "--cases", "1", "--seed", "1", "--crane", "/nowhere", "--out", out_}, "/nowhere");
  expect_refused({"withhold", "make", "--cases", "1", "--seed", "1", "--purpose", "score", "--out", out_}, "seed 1 is for \"tune\"");
  expect_refused({"withhold", "score", below_}, "no about.json");
}

TEST_F(ExitCodes, ANameThatCannotBeWritten) {
  expect_refused({"run", kScenario, "--out", file_}, "which is a file");
  expect_refused({"soak", "--seed", "1", "--hours", "1", "--out", file_}, "which is a file");
  expect_refused({"withhold", "make", "--cases", "1", "--seed", "1", "--out", file_}, "which is a file");
  expect_refused({"schema", "--out", file_}, "which is a file");
  expect_refused({"modes", kCrane, "--bode", below_}, "which is a folder");
  expect_refused({"modes", kCrane, "--bode", file_ + "/bode.csv"}, "which is a file");
  expect_refused({"export-fmu", kCrane, "--out", file_ + "/crane.fmu"}, "which is a file");
  expect_refused({"completion", "--out", below_}, "which is a folder");
  expect_refused({"cut", below_, "--out", below_}, "which is a folder");
  expect_refused({"accept", kScenario, "--junit", below_}, "which is a folder");
  EXPECT_EQ(contents(file_), "mine");
  EXPECT_EQ(contents(below_ + "/thesis.txt"), "mine");
}

}  // namespace
}  // namespace slewlab::tools
