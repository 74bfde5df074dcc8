// `slewlab diagnose` from the outside, as it is typed: a machine with an effect that the diagnosis is not told of runs over the wire,
// its log is diagnosed against the nominal crane, and what comes out is used. The expected answer is the machine's own file.

#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "common/effect.h"
#include "controller/controller_file.h"
#include "msgs/log_reader.h"
#include "msgs/log_writer.h"
#include "sim/effects/catalogue.h"
#include "tests/msgs/file_contents.h"
#include "tests/msgs/temporary_folder.h"
#include "tests/tools/running_program.h"

namespace slewlab::tools {
namespace {

namespace fs = std::filesystem;

const std::string kSlewlab = SLEWLAB_BINARY_DIR "/bin/slewlab";
const std::string kConfig = SLEWLAB_SOURCE_DIR "/config/";
constexpr double kBrakeTorque = 12.0;  // [Nm] of the machine that is measured

std::set<std::string> names_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename().string());
  return names;
}

class DiagnoseCommand : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    const fs::path machine = folder_->path() / "machine.yaml";
    std::ofstream(machine) << "include: " << kConfig << "cranes/thesis.yaml\n"
                           << "description: The machine that is measured; its boom is cut finer than the diagnosis cuts it.\n"
                           << "boom:\n"
                           << "  elements: {value: 32, unit: \"-\", source: \"test\"}\n"
                           << "effects:\n"
                           << "  - effect: dragging_brake\n"
                           << "    torque: {value: " << kBrakeTorque << ", unit: N m, source: \"test\"}\n"
                           << "    unevenness: {value: 0.3, unit: \"-\", source: \"test\"}\n"
                           << "    give: {value: 0.02, unit: rad, source: \"test\"}\n";
    RunningProgram run({kSlewlab, "run", kConfig + "scenarios/slew_there_and_back.yaml", "--out", (folder_->path() / "measured").string(),
                        "--progress", "none", "--set", "crane=" + machine.string(), "--set", "telemetry.sensors_period=1 ms", "--set",
                        "duration=24"});
    ASSERT_EQ(run.wait_for_end(), 0) << run.complaints();
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }

  static std::string log() { return (folder_->path() / "measured" / "run.lcmlog").string(); }
  fs::path out() const { return folder_->path() / testing::UnitTest::GetInstance()->current_test_info()->name(); }
  std::vector<std::string> command(const std::vector<std::string>& more) const {
    std::vector<std::string> all{kSlewlab, "diagnose", "--out", out().string()};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  std::vector<std::string> whole_command() const {
    return command({"--crane", kConfig + "cranes/thesis.yaml", "--controller", kConfig + "controllers/thesis.yaml", "--log", log()});
  }

  // Of the machine's catalogue: one effect is quick.
  static void leave_one(std::vector<std::string>& arguments, std::string_view effect) {
    for (const sim::EffectDescription* other : sim::effect_catalogue()) {
      if (other->about.name != effect) arguments.insert(arguments.end(), {"--without", std::string(other->about.name)});
    }
  }

  // Ends with this code and these words, and nothing is written.
  void expect_refused(const std::vector<std::string>& more, int code, const std::vector<std::string>& words) const {
    RunningProgram diagnose(command(more));
    EXPECT_EQ(diagnose.wait_for_end(), code);
    for (const std::string& word : words) EXPECT_NE(diagnose.complaints().find(word), std::string::npos) << diagnose.complaints();
    EXPECT_FALSE(fs::exists(out()));
  }

 private:
  static TemporaryFolder* folder_;
};
TemporaryFolder* DiagnoseCommand::folder_ = nullptr;

// 10 of the log's 24 s: the brake is found in them with its size, and predicts others.
TEST_F(DiagnoseCommand, OfALongLogAStretchIsFittedAndAnotherTriesTheAnswer) {
  std::vector<std::string> arguments = whole_command();
  arguments.insert(arguments.end(), {"--fitted-seconds", "10"});
  leave_one(arguments, "dragging_brake");
  RunningProgram diagnose(arguments);
  ASSERT_EQ(diagnose.wait_for_end(), 0) << diagnose.complaints();
  const auto found = nlohmann::json::parse(contents(out() / "diagnosis.json"));
  EXPECT_EQ(found["verdict"], "dragging_brake");
  const auto& size = found["causes"][0]["sizes"][0];
  EXPECT_LT(size["low_90"].get<double>(), kBrakeTorque);
  EXPECT_GT(size["high_90"].get<double>(), kBrakeTorque);
  ASSERT_EQ(found["unseen"].size(), 1u);
  EXPECT_EQ(found["unseen"][0]["log"].get<std::string>().rfind(log() + " ", 0), 0u) << found["unseen"][0]["log"];
  EXPECT_TRUE(found["unseen"][0]["validation"]["holds"].get<bool>());
  EXPECT_NE(contents(out() / "summary.txt").find("are fitted, where most moves, and "), std::string::npos);
}

TEST_F(DiagnoseCommand, FindsTheEffectAndWritesACraneThatRunTakes) {
  RunningProgram diagnose(whole_command());
  ASSERT_EQ(diagnose.wait_for_end(), 0) << diagnose.complaints();
  EXPECT_EQ(names_in(out()), (std::set<std::string>{"diagnosis.json", "diagnosis.html", "crane_with_effect.yaml", "crane_as_fitted.yaml", "series.csv", "summary.txt"}));

  const auto found = nlohmann::json::parse(contents(out() / "diagnosis.json"));
  EXPECT_TRUE(found["gap"].get<bool>());
  EXPECT_EQ(found["verdict"], "dragging_brake");
  EXPECT_GT(found["simulations"].get<int>(), 100);
  EXPECT_EQ(found["logs"], nlohmann::json::array({log()}));
  EXPECT_EQ(found["unseen_logs"], nlohmann::json::array());
  EXPECT_EQ(found["controller"], kConfig + "controllers/thesis.yaml");
  const auto& first = found["causes"][0];
  EXPECT_EQ(first["effects"], nlohmann::json::array({"dragging_brake"}));
  EXPECT_GT(first["probability"].get<double>(), 0.5);
  const auto torque = std::find_if(first["sizes"].begin(), first["sizes"].end(),
                                   [](const auto& size) { return size["parameter"] == "dragging_brake.torque"; });
  ASSERT_NE(torque, first["sizes"].end());
  EXPECT_EQ((*torque)["unit"], "N m");
  EXPECT_LT((*torque)["low_90"].get<double>(), kBrakeTorque);
  EXPECT_GT((*torque)["high_90"].get<double>(), kBrakeTorque);
  // The second half of the only log was fitted by nobody, and the law is the machine's own.
  EXPECT_NE(found["gaps_on"].get<std::string>().find("(not fitted; simulated from the operator's commands alone)"), std::string::npos) << found["gaps_on"];
  int torques = 0;
  for (const auto& gap : found["gaps"]) {
    if (gap["signal"].get<std::string>().find("torque") == std::string::npos) continue;
    ++torques;
    EXPECT_LT(gap["after"].get<double>(), 0.05 * gap["before"].get<double>()) << gap;
  }
  EXPECT_EQ(torques, 2);
  // The nominal crane's modes are marked: the thesis's boom has its first two at 1.3 and 5.2 Hz.
  const auto frequency = [&](const char* name) {
    const auto mode = std::find_if(found["modes"].begin(), found["modes"].end(), [&](const auto& one) { return one["name"] == name; });
    return mode == found["modes"].end() ? 0.0 : (*mode)["frequency_hz"].template get<double>();
  };
  EXPECT_NEAR(frequency("bending 1"), 1.3, 0.05);
  EXPECT_NEAR(frequency("bending 2"), 5.2, 0.05);
  // The page on the terminal says what the file says, and stays.
  for (const char* word : {"Is there a gap?  Yes", "Which side?", "Where?", "When?", "dragging_brake.torque", "outside the catalogue",
                           "Validation on", "simulations with"}) {
    EXPECT_NE(diagnose.output().find(word), std::string::npos) << word << "\n" << diagnose.output();
  }
  // The answer on standard output and nothing else: how far it is stands on standard error.
  EXPECT_EQ(diagnose.output().rfind(contents(out() / "summary.txt"), 0), 0u) << diagnose.output();
  EXPECT_NE(diagnose.complaints().find("100 %"), std::string::npos) << diagnose.complaints();
  const std::string page = contents(out() / "diagnosis.html");
  for (const char* word : {"dragging_brake", "Is there a gap?  Yes", "Plotly.react", "missing torque", "bending 2, 5.2 Hz"}) EXPECT_NE(page.find(word), std::string::npos) << word;

  EXPECT_NE(contents(out() / "crane_with_effect.yaml").find("elements: {value: 12,"), std::string::npos);  // kBoomElements, fit.h
  EXPECT_NE(contents(out() / "crane_with_effect.yaml").find(", 90 %: "), std::string::npos) << "sizes with their intervals";
  EXPECT_EQ(contents(out() / "crane_with_effect.yaml").find("include: /"), std::string::npos) << "both may be moved together";
  for (const char* crane : {"crane_with_effect.yaml", "crane_as_fitted.yaml"}) {
    const fs::path again = out() / "again";
    RunningProgram run({kSlewlab, "run", kConfig + "scenarios/slew_there_and_back.yaml", "--out", again.string(), "--progress", "none",
                        "--set", "crane=" + (out() / crane).string(), "--set", "duration=24"});
    EXPECT_EQ(run.wait_for_end(), 0) << run.complaints();
    EXPECT_EQ(nlohmann::json::parse(contents(again / "summary.json"))["outcome"], "complete") << crane;
  }
}

// Without a controller there is no closed loop to predict, but what is missing at the motors is drawn all the same.
TEST_F(DiagnoseCommand, DrawsWhatIsMissingWhereNoControllerIsGiven) {
  std::vector<std::string> all{"--crane", kConfig + "cranes/thesis.yaml", "--log", log()};
  leave_one(all, "dragging_brake");
  RunningProgram diagnose(command(all));
  ASSERT_EQ(diagnose.wait_for_end(), 0) << diagnose.complaints();
  EXPECT_NE(diagnose.output().find("The controller was not given."), std::string::npos) << diagnose.output();
  std::ifstream series(out() / "series.csv");
  std::string line;
  std::getline(series, line);
  EXPECT_EQ(line, "time_s,speed,missing_torque,missing_torque_after,torque,house,pivot,middle,tip");
  double before = 0.0, after = 0.0;
  while (std::getline(series, line)) {
    double time = 0.0, speed = 0.0, missing = 0.0, missing_after = 0.0;
    char comma = 0;
    ASSERT_TRUE(std::istringstream(line) >> time >> comma >> speed >> comma >> missing >> comma >> missing_after) << line;
    if (time < 12.0) continue;  // the impact when play is taken up is forgotten by then
    before += missing * missing;
    after += missing_after * missing_after;
  }
  EXPECT_GT(before, 0.0);
  EXPECT_LT(after, 0.01 * before);
  const std::string page = contents(out() / "diagnosis.html");
  EXPECT_NE(page.find("What is missing at the motors"), std::string::npos);
  EXPECT_EQ(page.find("from the operator's moves"), std::string::npos);
}

// Of a recorder that was switched on while the motors go through their play, what comes before the gears are pressed is not followed: what is drawn begins there, and
// each column ends with the record.
TEST_F(DiagnoseCommand, DrawsARecordFromWhereItIsFollowed) {
  constexpr std::int64_t kSwitchedOn = 300'000;  // [us] the motors are on their way through the play
  const fs::path later = out().parent_path() / "later.lcmlog";
  {
    msgs::LogReader reader(log());
    msgs::LogWriter writer(later);
    msgs::LogEvent event;
    while (reader.next(event)) {
      if (event.timestamp_us >= kSwitchedOn) writer.append(event.channel, event.timestamp_us, event.data);
    }
    writer.finish();
  }
  std::vector<std::string> all{"--crane", kConfig + "cranes/thesis.yaml", "--log", later.string()};
  leave_one(all, "dragging_brake");
  RunningProgram diagnose(command(all));
  ASSERT_EQ(diagnose.wait_for_end(), 0) << diagnose.complaints();
  std::ifstream series(out() / "series.csv");
  std::string line;
  std::getline(series, line);
  std::vector<double> times;
  double largest = 0.0, before_square = 0.0, after_square = 0.0;
  while (std::getline(series, line)) {
    double time = 0.0, speed = 0.0, missing = 0.0, after = 0.0;
    char comma = 0;
    ASSERT_TRUE(std::istringstream(line) >> time >> comma >> speed >> comma >> missing >> comma >> after) << line;
    times.push_back(time);
    largest = std::max({largest, std::fabs(missing), std::fabs(after)});
    if (time < times.front() + 3.0) continue;  // forgets its beginning by then
    before_square += missing * missing;
    after_square += after * after;
  }
  ASSERT_GT(times.size(), 100u);
  EXPECT_GT(times.front(), 0.8) << "the log begins at 0.3 s, and is not followed before its gears are pressed";
  EXPECT_NEAR(times.back(), 24.0, 0.1);
  EXPECT_LT(largest, 1000.0) << "four times what the motors can give";
  EXPECT_LT(after_square, 0.05 * before_square) << "the brake that was found explains it";
}

// The catalogue that is left does not hold the answer: no crane gets an effect that is not it.
TEST_F(DiagnoseCommand, AddsNothingToTheCraneWhereNothingKnownIsTheAnswer) {
  std::vector<std::string> all{"--crane", kConfig + "cranes/thesis.yaml", "--controller", kConfig + "controllers/thesis.yaml", "--log", log()};
  leave_one(all, "torque_limit");
  RunningProgram diagnose(command(all));
  ASSERT_EQ(diagnose.wait_for_end(), 0) << diagnose.complaints();
  const auto found = nlohmann::json::parse(contents(out() / "diagnosis.json"));
  EXPECT_GT(found["probability_unknown"].get<double>(), 0.5);
  for (const char* crane : {"crane_with_effect.yaml", "crane_as_fitted.yaml"}) {
    EXPECT_EQ(contents(out() / crane).find("effect:"), std::string::npos) << contents(out() / crane);
  }
  EXPECT_EQ(contents(out() / "crane_as_fitted.yaml").find("value:"), std::string::npos) << "no parameters either";
  EXPECT_NE(diagnose.output().find("the nearest cause, which is not the answer"), std::string::npos) << diagnose.output();
  EXPECT_NE(contents(out() / "diagnosis.html").find("which is not the answer"), std::string::npos);
}

// The controller of this log has a droop that its file does not tell; what comes out is that controller.
TEST_F(DiagnoseCommand, WritesTheControllerThatWasFound) {
  const fs::path other = out().parent_path() / "other.yaml";
  std::ofstream(other) << "include: " << kConfig << "controllers/thesis.yaml\nspeed_control:\n"
                       << "  droop: {value: 5, unit: rad/s, source: \"test\"}\n";
  const fs::path measured = out().parent_path() / "measured_with_droop";
  RunningProgram run({kSlewlab, "run", kConfig + "scenarios/slew_there_and_back.yaml", "--out", measured.string(), "--progress", "none", "--set",
                      "controller=" + other.string(), "--set", "telemetry.sensors_period=1 ms", "--set", "duration=24"});
  ASSERT_EQ(run.wait_for_end(), 0) << run.complaints();
  std::vector<std::string> all{"--crane", kConfig + "cranes/thesis.yaml", "--controller", kConfig + "controllers/thesis.yaml", "--log",
                               (measured / "run.lcmlog").string()};
  leave_one(all, "torque_limit");
  RunningProgram diagnose(command(all));
  ASSERT_EQ(diagnose.wait_for_end(), 0) << diagnose.complaints();
  const controller::ControllerSettings found = controller::load_controller_file(out() / "controller_with_effect.yaml").settings;
  EXPECT_NEAR(found.speed_control.droop, 5.0, 0.01) << diagnose.output();
  EXPECT_EQ(controller::changes_text(controller::load_controller_file(other).settings, found, "").find("ramp"), std::string::npos);
}

TEST_F(DiagnoseCommand, AnInterruptEndsItAndNothingIsWritten) {
  for (const int number : {SIGINT, SIGTERM}) {
    // How far it is stands on standard error, which is read here as if it were standard output.
    std::vector<std::string> both{"/bin/sh", "-c", "exec \"$0\" \"$@\" 2>&1"};
    const std::vector<std::string> whole = whole_command();
    both.insert(both.end(), whole.begin(), whole.end());
    RunningProgram diagnose(both);
    ASSERT_NE(diagnose.wait_for_line("replaying the controller"), "");
    ::kill(diagnose.pid(), number);
    EXPECT_EQ(diagnose.wait_for_end(), 128 + number);
    EXPECT_NE(diagnose.output().find("interrupted; nothing was written"), std::string::npos) << diagnose.output();
    EXPECT_FALSE(fs::exists(out()));
  }
}

TEST_F(DiagnoseCommand, RefusesACraneWithAnotherNumberOfMotorGroups) {
  expect_refused({"--crane", SLEWLAB_SOURCE_DIR "/config/cranes/one_group.yaml", "--log", log()}, 3,
                 {"cannot tell, because", "the log has 2 motor groups, the nominal crane 1"});
}

// Of a thousand elements one machine's modes take a minute or two, and a diagnosis tries thousands: refused as it is, it has said before how it cuts the boom.
TEST_F(DiagnoseCommand, CutsABoomOfAThousandElementsCoarserAndSaysSo) {
  const fs::path machine = out().string() + ".yaml";
  std::ofstream(machine) << "include: " << kConfig << "cranes/one_group.yaml\n"
                         << "boom:\n"
                         << "  elements: {value: 1000, unit: \"-\", source: \"test\"}\n";
  expect_refused({"--crane", machine.string(), "--log", log()}, 3, {"32 elements", "1000", "groups"});
}

TEST_F(DiagnoseCommand, NamesWhatIsWrongOnTheCommandLineBeforeAnyWork) {
  const std::string crane = kConfig + "cranes/thesis.yaml";
  expect_refused({"--crane", crane, "--log", log(), "--without", "draging_brake"}, 2, {"--without", "draging_brake", "'dragging_brake' is near"});
  const std::string axis = kConfig + "axes/example_axis.yaml";
  expect_refused({"--axis", axis, "--log", log(), "--without", "dragging_brake"}, 2, {"--without", "dragging_brake", "dry, viscous, offset"});
  expect_refused({"--axis", axis, "--log", log(), "--threads", "4"}, 2, {"--threads", "found 4", "no --threads beside an axis"});
  expect_refused({"--axis", axis, "--log", log(), "--measured-torque"}, 2, {"--measured-torque: found it, expected no --measured-torque beside an axis"});
  expect_refused({"--crane", crane, "--log", log(), "--log", log()}, 2, {"--log", log(), "each log once"});
  expect_refused({"--crane", crane, "--log", "/nowhere/run.lcmlog"}, 2, {"/nowhere/run.lcmlog: found no file or folder of that name"});
  expect_refused({"--crane", crane, "--log", kConfig + "cranes/thesis.yaml"}, 2, {"thesis.yaml holds no message that slewlab can read"});
  expect_refused({"--crane", "/nowhere/crane.yaml", "--log", log()}, 2, {"/nowhere/crane.yaml", "cannot be read"});
  expect_refused({"--axis", axis, "--log", log(), "--controller", "/nowhere"}, 2, {"--controller: found /nowhere, expected no --controller beside an axis"});
  std::ofstream(out()) << "a file\n";
  RunningProgram diagnose(whole_command());
  EXPECT_EQ(diagnose.wait_for_end(), 2);
  EXPECT_NE(diagnose.complaints().find("a folder, there already or to be made"), std::string::npos) << diagnose.complaints();
  EXPECT_EQ(contents(out()), "a file\n");
}

}  // namespace
}  // namespace slewlab::tools
