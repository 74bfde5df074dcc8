// What the programs make of a log that is not as it was written: none hangs, none judges it, none takes memory without
// bounds, and what they print is text. The damage is drawn: cut off, bits turned over, bytes put in, blocks written twice
// or lost.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>

#include "tests/msgs/file_contents.h"
#include "tests/msgs/temporary_folder.h"
#include "tests/tools/running_program.h"

namespace slewlab::tools {
namespace {

namespace fs = std::filesystem;

const std::string kSlewlab = SLEWLAB_BINARY_DIR "/bin/slewlab";
const std::string kThesis = SLEWLAB_SOURCE_DIR "/config/scenarios/thesis_slew.yaml";
const std::string kPython = SLEWLAB_SOURCE_DIR "/.venv/bin/python";

#ifdef SLEWLAB_SANITIZED  // whose shadow takes more address space than any limit, and ten times as long
constexpr const char *kMemory = "unlimited", *kPatience = "1200";
#else
constexpr const char* kMemory = "4000000";  // [KiB] of address space: ten times what the whole log takes
constexpr const char* kPatience = "120";    // [s] wall clock; a whole log takes one
#endif

std::string damaged(std::string log, std::mt19937_64& random) {
  const auto place = [&] { return static_cast<std::size_t>(random() % log.size()); };
  switch (random() % 5) {
    case 0: log.resize(place()); break;
    case 1:
      for (std::uint64_t i = 0, flips = 1 + random() % 20; i < flips; ++i) {
        log[place()] ^= static_cast<char>(1U << random() % 8);
      }
      break;
    case 2: {
      std::string noise(1 + random() % 500, '\0');
      for (char& c : noise) c = static_cast<char>(random());
      log.insert(place(), noise);
      break;
    }
    case 3: log.insert(place(), log.substr(place(), 1 + random() % 100'000)); break;
    default: log.erase(place(), 1 + random() % 100'000); break;
  }
  return log;
}

class DamagedLogTest : public testing::Test {
 protected:
  void SetUp() override {
    RunningProgram run({kSlewlab, "run", kThesis, "--out", folder_.path() / "run", "--progress", "none"});
    ASSERT_EQ(run.wait_for_end(), 0) << run.complaints();
    whole_ = contents(log_);
    ASSERT_FALSE(whole_.empty());
  }
  void store(const std::string& bytes) { std::ofstream(log_, std::ios::binary) << bytes; }

  // The exit code of a program that may take so much memory and time; 124 where it did not end.
  int exit_code(const std::vector<std::string>& command) {
    std::vector<std::string> line{"/bin/sh", "-c", std::string("ulimit -v ") + kMemory + "; exec timeout " + kPatience + " \"$@\"", "sh"};
    line.insert(line.end(), command.begin(), command.end());
    RunningProgram program(line);
    const int code = program.wait_for_end();
    output_ = program.output() + program.complaints();
    for (const char c : output_) {
      EXPECT_TRUE(c == '\n' || static_cast<unsigned char>(c) >= 0x20) << "byte " << static_cast<int>(c) << " of\n" << output_;
    }
    return code;
  }
  int accept() { return exit_code({kSlewlab, "accept", folder_.path() / "run", "--no-plot"}); }

  TemporaryFolder folder_;
  fs::path log_ = folder_.path() / "run/run.lcmlog";
  std::string whole_;
  std::string output_;
};

TEST_F(DamagedLogTest, AWholeLogIsAcceptedAndOneCutBeforeItsStopIsNot) {
  EXPECT_EQ(accept(), 0) << output_;
  store(whole_.substr(0, whole_.size() * 2 / 5));
  EXPECT_EQ(accept(), 1);
  EXPECT_NE(output_.find("no verdict"), std::string::npos) << output_;
  // Also where nothing tells what the run wrote, and where the cut is between two events.
  fs::remove(folder_.path() / "run/summary.json");
  EXPECT_EQ(accept(), 1);
  store(whole_.substr(0, whole_.find("\xED\xA1\xDA\x01", whole_.size() * 2 / 5)));
  EXPECT_EQ(accept(), 1);
  EXPECT_NE(output_.find("the run did not come to its end, or the log is cut off"), std::string::npos) << output_;
}

// Nothing vouches for the log any more: it is judged as long as it is whole by itself. The plant's status is said nowhere else.
TEST_F(DamagedLogTest, ALogWithoutASummaryIsAcceptedWhereItIsWholeAlone) {
  fs::remove(folder_.path() / "run/summary.json");
  EXPECT_EQ(accept(), 0) << output_;
  std::string without = whole_;
  for (std::size_t at = 0; (at = without.find("PLANT_STATUS", at)) != std::string::npos; ++at) without[at] = 'p';
  store(without);
  EXPECT_EQ(accept(), 1);
  EXPECT_NE(output_.find("no verdict, and NOT accepted: there is no PLANT_STATUS in the log, expected one every 1 s"), std::string::npos) << output_;
}

TEST_F(DamagedLogTest, ASummaryThatCannotBeReadIsToldAndGivesNoVerdict) {
  const std::string path = (folder_.path() / "run/summary.json").string();
  for (const auto& [text, said] : std::initializer_list<std::pair<std::string, std::string>>{
           {"{\"out", "text that is no JSON"}, {"null", "found null"}, {"{\"outcome\": 5}", "key 'outcome': found 5"},
           {"{\"outcome\": \"complete\", \"run\": {\"log_digest\": 3}}", "key 'run.log_digest': found 3, expected 16 hexadecimal digits"}}) {
    std::ofstream(path) << text;
    EXPECT_EQ(accept(), 1) << text;
    EXPECT_NE(output_.find("no verdict, and NOT accepted: " + path + ": "), std::string::npos) << output_;
    EXPECT_NE(output_.find(said), std::string::npos) << output_;
    EXPECT_EQ(output_.find("json.exception"), std::string::npos) << output_;
  }
}

// A twentieth of 60 s is too short to be judged.
TEST_F(DamagedLogTest, ADiagnosisThatRefusesADamagedLogTellsTheDamage) {
  store(whole_.substr(0, whole_.size() / 20));
  const std::string config = SLEWLAB_SOURCE_DIR "/config/";
  EXPECT_EQ(exit_code({kSlewlab, "diagnose", "--crane", config + "cranes/thesis.yaml", "--controller", config + "controllers/thesis.yaml",
                       "--log", log_, "--out", folder_.path() / "findings"}),
            3);
  EXPECT_NE(output_.find("s long; at least"), std::string::npos) << output_;
  EXPECT_NE(output_.find("This log is damaged, and that may be why:"), std::string::npos) << output_;
  EXPECT_NE(output_.find("the end is cut off"), std::string::npos) << output_;
}

// Some messages in the middle are gone, which the record bridges: the answer stands, and says of what.
TEST_F(DamagedLogTest, ADiagnosisOfADamagedLogSaysSoInItsAnswer) {
  std::string log = whole_;
  log.erase(log.size() / 2, 300);
  store(log);
  const std::string config = SLEWLAB_SOURCE_DIR "/config/";
  const fs::path findings = folder_.path() / "findings";
  EXPECT_EQ(exit_code({kSlewlab, "diagnose", "--crane", config + "cranes/thesis.yaml", "--controller", config + "controllers/thesis.yaml",
                       "--log", log_, "--out", findings}),
            0);
  const std::string summary = contents(findings / "summary.txt"), answer = summary.substr(0, summary.find('\n'));
  EXPECT_NE(answer.find("No effect is missing"), std::string::npos) << answer;
  EXPECT_NE(answer.find("damaged log)."), std::string::npos) << answer;
}

TEST_F(DamagedLogTest, NoDamageIsAcceptedAndEverythingEnds) {
  std::random_device source;
  const char* chosen = std::getenv("SLEWLAB_TEST_SEED");
  const std::uint64_t seed = chosen != nullptr ? std::strtoull(chosen, nullptr, 10) : source();
  std::mt19937_64 random(seed);
  constexpr int kRounds = 25;
  for (int round = 0; round < kRounds; ++round) {
    const std::string log = damaged(whole_, random);
    if (log == whole_) continue;
    SCOPED_TRACE("SLEWLAB_TEST_SEED=" + std::to_string(seed) + " round " + std::to_string(round));
    store(log);
    EXPECT_EQ(accept(), 1) << output_;
    const int replayed = exit_code({kSlewlab, "replay", folder_.path() / "run"});
    EXPECT_TRUE(replayed == 0 || replayed == 1 || replayed == 2) << replayed << "\n" << output_;
    if (round % 5 != 0 || !fs::exists(kPython)) continue;
    const int exported = exit_code({kSlewlab, "export", log_, "--format", "csv", "--out", folder_.path() / "exported"});
    EXPECT_TRUE(exported == 0 || exported == 1 || exported == 2) << exported << "\n" << output_;
    EXPECT_EQ(output_.find("Traceback"), std::string::npos) << output_;
    fs::remove_all(folder_.path() / "exported");
  }
}

}  // namespace
}  // namespace slewlab::tools
