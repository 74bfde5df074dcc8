#include "diagnosis/balance/described_axis.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>

#include "tests/diagnosis/balance/simulated_axis.h"
#include "tests/msgs/temporary_folder.h"

namespace slewlab::diagnosis {
namespace {

constexpr double kInertia = 2.0;       // [kg m^2] on the axis
constexpr double kMotorInertia = 0.5;  // [kg m^2] on the axis as well: there is no gear
constexpr double kStep = 2e-3;         // [s]

sim::MachineFile axis_file(double inertia, const std::string& more) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "axis.yaml";
  std::ofstream(file) << "kind: axis\ncoordinate: {value: rotary, source: test}\ninertia: {value: " << inertia << ", unit: kg m^2, source: test}\n"
                      << "rated_torque: {value: 20, unit: N m, source: test}\ntop_speed: {value: 3, unit: rad/s, source: test}\n" << more;
  return sim::load_machine_file(file);
}

const std::string kGravity = "load:\n  gravity: {value: 10, unit: N m, source: test}\n  gravity_angle: {value: 0, unit: deg, source: test}\n";
const std::string kGear =
    "motor_inertia: {value: 0.5, unit: kg m^2, source: test}\n"
    "transmission:\n  stiffness: {value: 2000, unit: N m/rad, source: test}\n  damping_ratio: {value: 2, unit: \"%\", source: test}\n";

// Over one sample the axis moves by a hundredth of a radian: the load of the middle, not of the beginning.
TEST(DescribedAxis, ALoadIsThatOfTheMiddleBetweenTwoSamples) {
  const std::vector<double> load = described_load(axis_file(kInertia, kGravity), {0.50, 0.51, 0.52}, kStep);
  ASSERT_EQ(load.size(), 3u);
  EXPECT_DOUBLE_EQ(load[0], 10.0 * std::cos(0.505));
  EXPECT_DOUBLE_EQ(load[1], 10.0 * std::cos(0.515));
  EXPECT_DOUBLE_EQ(load[2], 10.0 * std::cos(0.52)) << "after the last sample nothing is known";
}

// An axis of one inertia under gravity, against an integration that shares nothing with the plant.
TEST(DescribedAxis, OneInertiaGoesWhereItsTorqueAndGravityBringIt) {
  AxisRecord record = record_of({.inertia = kInertia, .resistance = [](double, double position, double) { return -10.0 * std::cos(position); },
                                 .effort = [](double time) { return -10.0 + 6.0 * std::sin(3.0 * time); }, .duration = 4.0, .step = kStep});
  const sim::MachineFile axis = axis_file(kInertia, kGravity);
  record.load = described_load(axis, record.position, record.step);
  for (std::size_t n = 0; n < record.load.size(); ++n) record.effort[n] += record.load[n];
  const AxisRecord described = described_record(axis, record);
  ASSERT_EQ(described.position.size(), record.position.size());
  double largest = 0.0, difference = 0.0;
  for (std::size_t n = 0; n < record.position.size(); ++n) {
    largest = std::max(largest, std::fabs(record.position[n]));
    difference = std::max(difference, std::fabs(described.position[n] - record.position[n]));
  }
  EXPECT_GT(largest, 0.3);
  EXPECT_LT(difference, 1e-3 * largest);
}

// Motor and load swing against each other: the motor alone begins to move at F / J_motor, the axis on the whole at F / (J + J_motor), and between them
// lies the mode sqrt(k (1 / J + 1 / J_motor)) = 70.7 rad/s.
TEST(DescribedAxis, BehindAGearTheMotorSwings) {
  const sim::MachineFile axis = axis_file(kInertia, kGear);
  AxisRecord record{"step", kStep, {}, {}, 0.0, {}};
  for (int n = 0; n < 500; ++n) {
    record.position.push_back(0.0);
    record.effort.push_back(n < 50 ? 0.0 : 5.0);
  }
  record.load.assign(record.position.size(), 0.0);
  const AxisRecord described = described_record(axis, record);
  const double time = 450 * kStep, whole = 0.5 * 5.0 / (kInertia + kMotorInertia) * time * time;
  EXPECT_NEAR(described.position.back(), whole, 0.02 * whole);
  EXPECT_EQ(described.position[50], 0.0);
  const double first = described.position[51], alone = 0.5 * 5.0 / kMotorInertia * kStep * kStep;
  EXPECT_NEAR(first, alone, 0.02 * alone);
  EXPECT_EQ(described.effort, record.effort);
}

}  // namespace
}  // namespace slewlab::diagnosis
