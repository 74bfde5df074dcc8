// A real machine: the servo axis of /work/shared/data, which is used from there and never copied.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <stdexcept>
#include <string>

#include "msgs/run_log.h"
#include "sim/machine/crane_file.h"
#include "sim/integrate/machine.h"
#include "tests/msgs/temporary_folder.h"

namespace slewlab::diagnosis {
namespace {

const std::filesystem::path kData = "/work/shared/data/servo_axis/run_a.csv";
const std::filesystem::path kFiles = SLEWLAB_SOURCE_DIR "/tests/diagnosis/servo_axis";

constexpr double kForceScale = 5000.0;                                     // [-] map.yaml
constexpr double kTravel = 2.5e-3 / (2.0 * std::numbers::pi);              // [m/rad] of the motor, map.yaml
constexpr double kMass = 95.0;                                             // [kg] README.md of the data
constexpr double kStep = 1e-3;                                             // [s]

// The log that `slewlab import` makes of the data.
msgs::RunLog import_servo_axis(const std::filesystem::path& folder) {
  const std::filesystem::path log = folder / "servo_axis.lcmlog";
  const std::string command = "SLEWLAB_PYTHON_MESSAGES=" SLEWLAB_BINARY_DIR "/python " SLEWLAB_SOURCE_DIR
                              "/.venv/bin/python " SLEWLAB_SOURCE_DIR "/tools/python/import_data.py --map " +
                              (kFiles / "map.yaml").string() + " --out " + log.string() + " " + kData.string() +
                              " > " + (folder / "said.txt").string();
  if (std::system(command.c_str()) != 0) throw std::runtime_error("import failed: " + command);
  return msgs::read_run_logs(log).runs.at(0);
}

sim::MachineSettings makers_machine() {
  sim::MachineSettings settings;
  settings.crane = sim::load_crane_file(kFiles / "crane.yaml", {}).parameters;
  settings.step = kStep;
  return settings;
}

// The maker's model is m x'' = F. Under F = 100 N sin(2 pi 3 Hz t), held over each step, the speed is the sum of the
// held forces over the mass, exactly; the gear's spring and 1 % of the mass behind it may move it by 1e-4 of the top.
TEST(ServoAxis, CraneIsARigidMassOf95Kilograms) {
  sim::Machine machine = sim::make_machine(makers_machine());
  sim::DriveCommand command;
  double speed = 0.0, largest = 0.0, worst = 0.0;  // [m/s]
  for (int k = 0; k < 2000; ++k) {
    const double force = 100.0 * std::sin(2.0 * std::numbers::pi * 3.0 * k * kStep);  // [N]
    command.motor_torque[0] = force * kForceScale * kTravel;
    sim::step(machine, command);
    speed += force * kStep / kMass;
    largest = std::max(largest, std::fabs(speed));
    worst = std::max(worst, std::fabs(sim::read(machine).shaft_speed[0] * kTravel - speed));
  }
  EXPECT_LT(worst, 1e-4 * largest) << "of " << largest << " m/s";
}

TEST(ServoAxis, ImportKeepsEverySample) {
  if (!std::filesystem::exists(kData)) GTEST_SKIP() << "the measured servo axis is not here: " << kData;
  const TemporaryFolder folder;
  const msgs::RunLog run = import_servo_axis(folder.path());
  ASSERT_EQ(run.encoder.size(), 24841u);  // README.md of the data
  ASSERT_EQ(run.torque.size(), 24841u);
  EXPECT_EQ(run.encoder.back().simulated_time, 24'840'000'000);
  // Rows 1 and 24841 of the file: 0.000007450 m, and 89.23443 N.
  EXPECT_EQ(run.encoder.front().shaft_position.at(0), 0.0);
  EXPECT_NEAR(run.torque.front().motor_torque.at(0), 89.23443 * kForceScale * kTravel, 1e-4);
}

}  // namespace
}  // namespace slewlab::diagnosis
