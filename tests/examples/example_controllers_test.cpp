// The controllers of examples/ against ours, which they write down again in another language. The one in Structured Text is run by
// slewlab-st-host.
//
// Two comparisons, and where their tolerances come from:
// - Replay: fed with the same recorded motion they must answer the same but for the rounding of one step. Torques are at
//   most 250 Nm, where the spacing of doubles is 2.8e-14 Nm; a few roundings and an integral over 6000 steps stay below
//   1e-9 Nm, the tolerance. (Measured: 6e-14 Nm. The map's shares are written 0.93 here and 93 % there.)
// - Closed loop: the crane carries a rounding on. Until the emergency stop it is damped and the gears stay in contact, so
//   that it must stay tiny: 1e-6 Nm of 250 Nm. Behind the stop gears pass their play; impacts amplify any difference,
//   and what must agree there is what a person would read off: the peak of the tip's acceleration, within 5 %.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>

#include "msgs/lcm_bus.h"
#include "msgs/run_log.h"
#include "tests/msgs/temporary_folder.h"
#include "tests/tools/running_program.h"
#include "tools/replay/comparison.h"

namespace slewlab {
namespace {

namespace fs = std::filesystem;

const std::string kSlewlab = SLEWLAB_BINARY_DIR "/bin/slewlab";
const std::string kPlant = SLEWLAB_BINARY_DIR "/bin/slewlab-plant";
const std::string kScenarios = SLEWLAB_SOURCE_DIR "/config/scenarios/";
const std::string kPython = SLEWLAB_SOURCE_DIR "/.venv/bin/python";
const std::string kPythonController = "PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=" SLEWLAB_BINARY_DIR "/python " + kPython +
                                      " " SLEWLAB_SOURCE_DIR "/examples/controller_in_python/controller.py";
const std::string kCController = SLEWLAB_BINARY_DIR "/examples/controller_in_c/controller";
const std::string kStructuredTextController = SLEWLAB_BINARY_DIR "/bin/slewlab-st-host " SLEWLAB_BINARY_DIR "/tests/slewing_controller.so";

class ExampleControllersTest : public testing::TestWithParam<std::string> {
 protected:
  static bool is_python() { return GetParam() == "Python"; }
  static const std::string& its_command() {
    return is_python() ? kPythonController : GetParam() == "C" ? kCController : kStructuredTextController;
  }
  void SetUp() override {
    if (is_python() && !fs::exists(kPython)) GTEST_SKIP() << "no .venv here (tools/setup makes it)";
  }
  fs::path run(const std::string& scenario, const std::string& name, const std::string& controller = "") {
    const fs::path out = folder_.path() / name;
    std::vector<std::string> command{kSlewlab, "run", kScenarios + scenario, "--out", out.string(), "--progress", "none"};
    if (!controller.empty()) command.insert(command.end(), {"--controller", controller});
    RunningProgram program(command);
    EXPECT_EQ(program.wait_for_end(), 0) << program.complaints();
    return out;
  }
  TemporaryFolder folder_;
};

// Starts, stops, reversals and changes of mind on the way, an emergency stop: the same answers to each.
TEST_P(ExampleControllersTest, AnswersAsOursDoes) {
  for (const std::string scenario : {"thesis_slew.yaml", "slew_there_and_back.yaml", "inching.yaml"}) {
    const fs::path record = run(scenario, scenario);
    std::vector<std::string> command{kSlewlab, "replay", record.string(), "--controller", its_command()};
    for (const char* field : {"TORQUE.motor_torque", "CONTROLLER_STATE.ramped_speed", "CONTROLLER_STATE.average_torque",
                              "CONTROLLER_STATE.offset_torque", "CONTROLLER_STATE.proportional_torque",
                              "CONTROLLER_STATE.integral_torque"}) {
      command.insert(command.end(), {"--tolerance", std::string(field) + "=1e-9"});
    }
    RunningProgram replay(command);
    EXPECT_EQ(replay.wait_for_end(), 0) << replay.output() << replay.complaints();
    EXPECT_NE(replay.output().find("TORQUE               6000 compared"), std::string::npos) << replay.output();
  }
}

// Each scenario's own `expect:` (docs/faults.md); `slewlab run` ends with 1 where it does not come about.
TEST_P(ExampleControllersTest, RefusesReadingsThatNoMotorCanHave) {
  for (const std::string scenario : {"encoder_bits", "encoder_frozen", "encoder_noisy", "encoder_dropped", "torque_runaway"}) {
    run("faults/" + scenario + ".yaml", scenario, its_command());
  }
}

double peak_tip_acceleration(const msgs::RunLog& run) {
  double peak = 0.0;
  for (const msgs::Sensors& sensors : run.sensors) peak = std::max(peak, std::abs(sensors.tip_acceleration));
  return peak;
}

TEST_P(ExampleControllersTest, DrivesTheCraneAsOursDoes) {
  const msgs::RunLog ours = msgs::read_run_logs(run("thesis_slew.yaml", "ours") / "run.lcmlog").runs.at(0);
  const msgs::RunLog its = msgs::read_run_logs(run("thesis_slew.yaml", "its", its_command()) / "run.lcmlog").runs.at(0);
  ASSERT_EQ(its.torque.size(), ours.torque.size());
  for (std::size_t i = 0; i < ours.torque.size() && ours.torque[i].simulated_time < 30'000'000'000; ++i) {
    for (std::size_t group = 0; group < 2; ++group) {
      ASSERT_NEAR(its.torque[i].motor_torque[group], ours.torque[i].motor_torque[group], 1e-6) << "TORQUE " << i;
    }
  }
  EXPECT_NEAR(peak_tip_acceleration(its), peak_tip_acceleration(ours), 0.05 * peak_tip_acceleration(ours));
}

// One controller, two plants one after the other on one bus: the second is answered as the first was, from a fresh state.
void expect_to_answer_two_runs(const std::string& controller_command, const fs::path& folder) {
  const msgs::ReservedPort port;
  const std::string bus = msgs::bus_url(port.number());
  RunningProgram controller({"/bin/sh", "-c", "export SLEWLAB_BUS='" + bus + "' LCM_DEFAULT_URL='" + bus +
                                                  "' SLEWLAB_CONTROLLER_PERIOD_MS=10; exec " + controller_command});
  std::vector<msgs::RunLog> runs;
  for (const char* name : {"first.lcmlog", "second.lcmlog"}) {
    RunningProgram plant({kPlant, "--scenario", kScenarios + "thesis_slew.yaml", "--bus", bus, "--log", (folder / name).string(), "--set",
                          "duration=6"});
    ASSERT_EQ(plant.wait_for_end(), 0) << plant.complaints();
    runs.push_back(msgs::read_run_logs(folder / name).runs.at(0));
  }
  kill(controller.pid(), SIGTERM);
  controller.wait_for_end();
  EXPECT_NE(runs[0].run_identity, runs[1].run_identity);
  ASSERT_EQ(runs[0].torque.size(), 600u);
  ASSERT_EQ(runs[1].torque.size(), 600u);
  for (std::size_t i = 0; i < 600; ++i) {
    EXPECT_EQ(runs[1].torque[i].run_identity, runs[1].run_identity);
    EXPECT_EQ(runs[1].torque[i].sequence, runs[0].torque[i].sequence);
    ASSERT_EQ(runs[1].torque[i].motor_torque, runs[0].torque[i].motor_torque) << "TORQUE " << i;
  }
}

TEST_P(ExampleControllersTest, OutlivesAPlantAndAnswersTheNext) {
  expect_to_answer_two_runs(is_python() ? "env " + its_command() : its_command(), folder_.path());
}

TEST(OurController, OutlivesAPlantAndAnswersTheNext) {
  const TemporaryFolder folder;
  expect_to_answer_two_runs(SLEWLAB_BINARY_DIR "/bin/slewlab-controller --config " SLEWLAB_SOURCE_DIR "/config/controllers/thesis.yaml",
                            folder.path());
}

INSTANTIATE_TEST_SUITE_P(, ExampleControllersTest, testing::Values("Python", "C", "StructuredText"),
                         [](const auto& each) { return each.param; });

}  // namespace
}  // namespace slewlab
