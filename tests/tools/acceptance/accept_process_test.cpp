// slewlab accept as a user starts it. The thesis's controller passes; the controller of examples/controller_in_python,
// with one line of it made wrong, is caught by the check that is there for it.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "tests/msgs/file_contents.h"
#include "tests/msgs/temporary_folder.h"
#include "tests/tools/running_program.h"

namespace slewlab::tools {
namespace {

namespace fs = std::filesystem;

const std::string kSlewlab = SLEWLAB_BINARY_DIR "/bin/slewlab";
const std::string kScenarios = SLEWLAB_SOURCE_DIR "/config/scenarios/";
const std::string kPython = SLEWLAB_SOURCE_DIR "/.venv/bin/python";
const std::string kExample = SLEWLAB_SOURCE_DIR "/examples/controller_in_python/controller.py";

class AcceptTest : public testing::Test {
 protected:
  // The names of the failed checks; `command` is a controller's, empty: ours.
  std::set<std::string> failures(const std::string& scenario, const std::string& command, int exit_code) {
    std::vector<std::string> line{kSlewlab, "accept", kScenarios + scenario, "--out", out_.string(), "--junit",
                                  (folder_.path() / "junit.xml").string()};
    if (!plot_) line.push_back("--no-plot");
    if (!command.empty()) line.insert(line.end(), {"--controller", command});
    RunningProgram accept(line);
    EXPECT_EQ(accept.wait_for_end(), exit_code) << accept.output() << accept.complaints();
    output_ = accept.output();
    std::set<std::string> failed;
    const auto result = nlohmann::json::parse(contents(out_ / "acceptance.json"), nullptr, false);
    if (!result.is_object()) return {"no acceptance.json"};
    for (const auto& check : result["checks"]) {
      if (check["verdict"] == "fail") failed.insert(check["name"].get<std::string>());
    }
    return failed;
  }
  // The example with `right` replaced.
  std::string wrong_controller(const std::vector<std::pair<std::string, std::string>>& changes) {
    std::string text = contents(kExample);
    for (const auto& [right, wrong] : changes) {
      const std::size_t at = text.find(right);
      EXPECT_NE(at, std::string::npos) << right << " is no longer in " << kExample;
      if (at != std::string::npos) text.replace(at, right.size(), wrong);
    }
    const fs::path file = folder_.path() / "wrong.py";
    std::ofstream(file) << text;
    return "PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=" SLEWLAB_BINARY_DIR "/python " + kPython + " " + file.string();
  }
  bool no_python() const { return !fs::exists(kPython); }

  TemporaryFolder folder_;
  fs::path out_ = folder_.path() / "out";
  std::string output_;
  bool plot_ = false;  // takes longer than all else
};

TEST_F(AcceptTest, TheThesissControllerPasses) {
  for (const char* scenario : {"thesis_slew.yaml", "slew_there_and_back.yaml", "inching.yaml", "low_boom_stop.yaml"}) {
    EXPECT_EQ(failures(scenario, "", 0), std::set<std::string>{}) << output_;
  }
  EXPECT_NE(contents(folder_.path() / "junit.xml").find("failures=\"0\""), std::string::npos);
}

TEST_F(AcceptTest, WithoutPlayCompensationTheCrossingsAreCaught) {
  plot_ = true;
  const auto failed = failures("thesis_slew_without_play_compensation.yaml", "", 1);
  EXPECT_TRUE(failed.contains("play crossings")) << output_;
  if (!no_python()) {
    const std::string page = contents(out_ / "acceptance.html");  // the reason stands there, and marks the picture
    EXPECT_NE(page.find("gearboxes passing their play before the emergency stop"), std::string::npos);
    EXPECT_NE(page.find("\"text\":\"play crossings\""), std::string::npos);
  }
}

// The example that watches its readings lets go of such a crane before anything is asked of it: one that does not.
TEST_F(AcceptTest, ASignErrorIsCaughtByTheDirection) {
  if (no_python()) GTEST_SKIP() << "no .venv here";
  const auto failed = failures("thesis_slew.yaml",
                               wrong_controller({{"c.step(reference - speed)", "c.step(speed - reference)"},
                                                 {"SPEED_LIMIT = 1.3 * TOP_SPEED * RATIO", "SPEED_LIMIT = math.inf"},
                                                 {"ACCELERATION_LIMIT = 800.0", "ACCELERATION_LIMIT = math.inf"}}), 1);
  EXPECT_TRUE(failed.contains("direction")) << output_;
  EXPECT_TRUE(failed.contains("settling")) << output_;
}

TEST_F(AcceptTest, AnIntegratorThatWindsUpIsCaughtByTheOvershootOfTheStop) {
  if (no_python()) GTEST_SKIP() << "no .venv here";
  const std::string windup = wrong_controller(
      {{"        if not winds_up:\n            self.integral += growth\n", "        self.integral += growth\n"},
       {"        self.integral = clamp(self.integral, -TORQUE_LIMIT, TORQUE_LIMIT)\n", ""}});
  EXPECT_EQ(failures("low_boom_stop.yaml", windup, 1), std::set<std::string>{"stop overshoot"}) << output_;
}

TEST_F(AcceptTest, SwappedHalvesOfThePlayCompensationAreCaughtByItsOffset) {
  if (no_python()) GTEST_SKIP() << "no .venv here";
  const std::string swapped = wrong_controller(
      {{"return (half_1, half_2) if average >= 0.0 else (-half_2, -half_1)",
        "return (half_2, half_1) if average >= 0.0 else (-half_1, -half_2)"}});
  EXPECT_EQ(failures("thesis_slew.yaml", swapped, 1), std::set<std::string>{"play offset"}) << output_;
}

// Swapped for one sign of the torque only: the halves change over where it passes zero, and the gears pass their play.
TEST_F(AcceptTest, HalvesSwappedForOneDirectionAreCaughtByThePlayCrossings) {
  if (no_python()) GTEST_SKIP() << "no .venv here";
  const std::string half_swapped =
      wrong_controller({{"else (-half_2, -half_1)", "else (-half_1, -half_2)"}});
  const auto failed = failures("slew_there_and_back.yaml", half_swapped, 1);
  EXPECT_TRUE(failed.contains("play crossings")) << output_;
  EXPECT_TRUE(failed.contains("play offset")) << output_;
}

// A fault on purpose: the controller must be good until then, the crane must stand in time behind it. The same run with
// another expectation of the scenario fails by that.
TEST_F(AcceptTest, TheReactionToAFaultIsJudged) {
  EXPECT_EQ(failures("faults/controller_killed.yaml", "", 0), std::set<std::string>{}) << output_;
  EXPECT_NE(output_.find("pass reaction"), std::string::npos) << output_;
  RunningProgram other({kSlewlab, "accept", kScenarios + "faults/controller_killed.yaml", "--out", out_.string(), "--no-plot",
                        "--set", "expect.drive_state=running"});
  EXPECT_EQ(other.wait_for_end(), 1);
  EXPECT_NE(other.output().find("FAIL expectation"), std::string::npos) << other.output();
}

// Two runs, a requirement that is met and one that is not, and the same plan with the deviation agreed.
TEST_F(AcceptTest, ARecordTracesRequirementsToRunsThatCanBeMadeAgain) {
  const fs::path plan = folder_.path() / "plan.yaml";
  const auto record = [&](const std::string& deviations, int exit_code) {
    std::ofstream(plan) << "kind: acceptance_plan\ntitle: Two runs\nsystem: slewlab-controller\nlimits: " SLEWLAB_SOURCE_DIR "/config/acceptance/thesis.yaml\n"
                        << "tests:\n  - {name: killed, purpose: dies, scenario: " << kScenarios << "faults/controller_killed.yaml}\n"
                        << "  - {name: open, purpose: play, scenario: " << kScenarios << "thesis_slew_without_play_compensation.yaml}\n"
                        << "requirements:\n  - {name: rest, text: Comes to rest., source: chosen, shown_by: [{test: killed, check: reaction}]}\n"
                        << "  - {name: play, text: Keeps its flanks., source: chosen, shown_by: [{test: open, check: play crossings}, {test: open, check: play offset}]}\n"
                        << deviations;
    std::vector<std::string> line{kSlewlab, "accept", "--record", plan.string(), "--out", out_.string()};
    if (no_python()) line.push_back("--no-plot");
    RunningProgram accept(line);
    EXPECT_EQ(accept.wait_for_end(), exit_code) << accept.output() << accept.complaints();
    return accept.output();
  };
  const std::string said = record("", 1);
  EXPECT_NE(said.find("met       rest"), std::string::npos) << said;
  EXPECT_NE(said.find("not met   play"), std::string::npos) << said;
  const auto told = nlohmann::json::parse(contents(out_ / "record.json"));
  EXPECT_FALSE(told["accepted"].get<bool>());
  EXPECT_EQ(told["tests"][0]["case"], "failure");
  EXPECT_EQ(told["tests"][1]["case"], "normal operation");
  const auto summary = nlohmann::json::parse(contents(out_ / "open" / "summary.json"));
  EXPECT_EQ(told["tests"][1]["log_digest"], summary["run"]["log_digest"]);
  EXPECT_EQ(told["tests"][1]["configuration_hash"], summary["run"]["configuration_hash"]);
  EXPECT_NE(contents(out_ / "record.xml").find("<testsuite name=\"killed\""), std::string::npos);
  std::map<std::string, std::string> sides;
  for (const auto& file : told["files"]) sides[file["of"]] = fs::path(file["file"].get<std::string>()).filename();
  EXPECT_EQ(sides, (std::map<std::string, std::string>{{"controller", "slewlab-controller"}, {"plant", "slewlab-plant"}}));
  if (!no_python()) {
    const std::string page = contents(out_ / "record.html");
    EXPECT_NE(page.find("Keeps its flanks."), std::string::npos);
    EXPECT_NE(page.find(summary["run"]["log_digest"].get<std::string>()), std::string::npos);
  }
  record("deviations: [{requirement: play, text: compensation comes later, agreed_by: the owner}]\n", 1);  // tip acceleration is a finding
  const auto agreed = nlohmann::json::parse(contents(out_ / "record.json"));
  EXPECT_EQ(agreed["requirements"][1]["deviation"], "compensation comes later");
  EXPECT_FALSE(agreed["findings"].empty());
}

// The record is of the controller that was asked for, and says which file that was.
TEST_F(AcceptTest, ARecordIsOfTheControllerAndThePlantThatWereNamed) {
  if (no_python()) GTEST_SKIP() << "no .venv here";
  const fs::path plan = folder_.path() / "plan.yaml", fmu = folder_.path() / "controller.fmu";
  std::ofstream(plan) << "kind: acceptance_plan\ntitle: One run\nsystem: a controller\nlimits: " SLEWLAB_SOURCE_DIR "/config/acceptance/thesis.yaml\n"
                      << "tests:\n  - {name: slew, purpose: speed, scenario: " << kScenarios << "thesis_slew.yaml}\n"
                      << "requirements:\n  - {name: side, text: Turns., source: chosen, shown_by: [{test: slew, check: direction}]}\n";
  RunningProgram made({kSlewlab, "export-fmu", SLEWLAB_SOURCE_DIR "/config/controllers/thesis.yaml", "--out", fmu.string()});
  ASSERT_EQ(made.wait_for_end(), 0) << made.complaints();
  const std::string plant = "PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=" SLEWLAB_BINARY_DIR "/python " + kPython + " " SLEWLAB_SOURCE_DIR "/examples/plant_in_python/plant.py";
  RunningProgram accept({kSlewlab, "accept", "--record", plan.string(), "--controller-fmu", fmu.string(), "--plant", plant, "--out", out_.string()});
  EXPECT_EQ(accept.wait_for_end(), 0) << accept.output() << accept.complaints();
  const auto summary = nlohmann::json::parse(contents(out_ / "slew" / "summary.json"));
  EXPECT_EQ(summary["controller_command"], "FMU " + fmu.string());
  EXPECT_EQ(summary["plant_command"], plant);
  const auto told = nlohmann::json::parse(contents(out_ / "record.json"));
  EXPECT_EQ(told["controller_command"], "FMU " + fmu.string());
  EXPECT_EQ(told["plant_command"], plant);
  std::map<std::string, std::string> digests;
  for (const auto& file : told["files"]) digests[file["file"]] = file["sha256"];
  EXPECT_EQ(digests[fmu.string()].size(), 64u);
  EXPECT_EQ(digests[SLEWLAB_SOURCE_DIR "/examples/plant_in_python/plant.py"].size(), 64u);
  const std::string page = contents(out_ / "record.html");
  EXPECT_NE(page.find(digests[fmu.string()]), std::string::npos);

  const std::string sides = " --controller-fmu " + fmu.string() + " --plant '" + plant + "'";
  EXPECT_EQ(told["command"], "cd " + fs::current_path().string() + " && slewlab accept --record " + plan.string() + sides + " --out " + out_.string());
  EXPECT_EQ(told["tests"][0]["command"], "cd " + fs::current_path().string() + " && slewlab accept " + kScenarios + "thesis_slew.yaml --limits " SLEWLAB_SOURCE_DIR "/config/acceptance/thesis.yaml" + sides);
}

// Before the first run is made.
TEST_F(AcceptTest, ARecordWithRunsThatThePlantCannotTakeIsRefused) {
  RunningProgram accept({kSlewlab, "accept", "--record", SLEWLAB_SOURCE_DIR "/config/acceptance_plans/thesis.yaml", "--plant", "true", "--out", out_.string()});
  EXPECT_EQ(accept.wait_for_end(), 2);
  EXPECT_NE(accept.complaints().find("controller_killed.yaml: not by a plant of one's own (--plant): it has faults on purpose"), std::string::npos) << accept.complaints();
  EXPECT_FALSE(fs::exists(out_));
}

TEST_F(AcceptTest, AControllerThatDiesIsNotAccepted) {
  EXPECT_EQ(failures("thesis_slew.yaml", "echo out of licences >&2; exit 3", 1).count("run"), 1u) << output_;
  EXPECT_NE(output_.find("exit code 3"), std::string::npos) << output_;
}

// Whoever reads acceptance.json can tell whether it is of the log beside it.
TEST_F(AcceptTest, TheVerdictNamesTheLogThatItJudged) {
  EXPECT_EQ(failures("faults/controller_killed.yaml", "", 0), std::set<std::string>{}) << output_;
  const auto verdict = nlohmann::json::parse(contents(out_ / "acceptance.json"));
  EXPECT_EQ(verdict["log_digest"], nlohmann::json::parse(contents(out_ / "summary.json"))["run"]["log_digest"]);
  RunningProgram again({kSlewlab, "run", kScenarios + "thesis_slew.yaml", "--set", "duration=1 s", "--out", out_.string(), "--progress", "none"});
  EXPECT_EQ(again.wait_for_end(), 0) << again.complaints();
  EXPECT_FALSE(fs::exists(out_ / "acceptance.json"));
}

TEST_F(AcceptTest, AFolderThatIsNoRunIsNamed) {
  RunningProgram accept({kSlewlab, "accept", folder_.path().string()});
  EXPECT_EQ(accept.wait_for_end(), 2);
  EXPECT_NE(accept.complaints().find(folder_.path().string() + ": found a folder without scenario.yaml, expected a scenario, or the folder of a run"),
            std::string::npos) << accept.complaints();
}

}  // namespace
}  // namespace slewlab::tools
