#include "tools/replay/open_loop.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace slewlab::tools {
namespace {

constexpr double kInertia = 12.0, kMotor = 0.002, kRatio = 50.0;     // [kg m^2], [kg m^2], [-]
constexpr double kTotal = kInertia + kMotor * kRatio * kRatio;       // [kg m^2] on the axis
constexpr std::int64_t kPeriod = 4'000'000;                          // [ns]

sim::MachineFile rigid_axis() {
  sim::MachineFile file;
  file.kind = sim::MachineKind::axis;
  file.parameters.boom.element_count = 0;
  file.parameters.drive.group_count = file.parameters.drive.motors_per_group = 1;
  file.parameters.drive.is_rigid = true;
  file.parameters.drive.motor_inertia = kMotor;
  file.parameters.drive.gearbox_ratio = kRatio;
  file.parameters.drive.rated_torque = 8.0;
  file.parameters.drive.top_speed = 2.0;
  file.parameters.house.inertia = kInertia;
  return file;
}

// A record of `count` periods under one torque, that begins at these readings of the motor; what follows them is of no account.
msgs::RunLog record(int count, double torque, double position, double speed) {
  msgs::RunLog run;
  run.configuration_hash = 7;
  for (int k = 0; k < count; ++k) {
    msgs::Encoder encoder{};
    encoder.sequence = 100 + k;
    encoder.simulated_time = 3'000'000'000 + k * kPeriod;
    encoder.group_count = 1;
    encoder.shaft_position = {position};
    encoder.shaft_speed = {speed};
    run.encoder.push_back(encoder);
    msgs::Torque answer{};
    answer.answered_sequence = encoder.sequence;
    answer.simulated_time = encoder.simulated_time;
    answer.enable = true;
    answer.group_count = 1;
    answer.motor_torque = {torque};
    run.torque.push_back(answer);
    msgs::Sensors sensors{};
    sensors.simulated_time = encoder.simulated_time;
    sensors.slew_angle = 0.5;
    sensors.house_acceleration = sensors.pivot_acceleration = sensors.middle_acceleration = sensors.tip_acceleration =
        std::numeric_limits<double>::quiet_NaN();
    run.sensors.push_back(sensors);
  }
  return run;
}

TEST(OpenLoop, GoesOnFromTheRecordsMotionUnderItsTorque) {
  const OpenLoopRun found = simulate_open_loop(rigid_axis(), {}, record(251, 4.0, 30.0, -20.0), 1e-3, 9);
  ASSERT_EQ(found.run.encoder.size(), 251u);
  EXPECT_TRUE(found.remarks.empty());
  EXPECT_DOUBLE_EQ(found.step, 1e-3);
  EXPECT_EQ(found.run.encoder.front().shaft_position[0], 30.0);
  EXPECT_EQ(found.run.encoder.front().shaft_speed[0], -20.0);
  const double t = 1.0, acceleration = 4.0 * kRatio * kRatio / kTotal;  // [rad/s^2] of the motor
  EXPECT_NEAR(found.run.encoder.back().shaft_speed[0], -20.0 + acceleration * t, 1e-9);
  EXPECT_NEAR(found.run.encoder.back().shaft_position[0], 30.0 - 20.0 * t + 0.5 * acceleration * t * t, 1e-9);
  EXPECT_EQ(found.run.encoder.back().configuration_hash, 9);
  EXPECT_EQ(found.run.encoder.back().sequence, 350);
  EXPECT_EQ(found.run.torque.back().motor_torque[0], 4.0);
  // The load-side encoder begins where the record's does and turns with the axis; what was not measured is not made up.
  EXPECT_NEAR(found.run.sensors.front().slew_angle, 0.5, 1e-15);
  EXPECT_NEAR(found.run.sensors.back().slew_angle - 0.5, (found.run.encoder.back().shaft_position[0] - 30.0) / kRatio, 1e-12);
  EXPECT_TRUE(std::isnan(found.run.sensors.back().tip_acceleration));
}

TEST(OpenLoop, StepsBelowTheRecordsPeriod) {
  msgs::RunLog slow = record(151, 4.0, 0.0, 0.0);
  for (std::size_t k = 0; k < slow.encoder.size(); ++k) {  // 150 Hz, stamped in whole nanoseconds
    slow.encoder[k].simulated_time = slow.torque[k].simulated_time = slow.sensors[k].simulated_time = std::llround(static_cast<double>(k) * 1e9 / 150.0);
  }
  const OpenLoopRun found = simulate_open_loop(rigid_axis(), {}, slow, 1e-3, 9);
  EXPECT_NEAR(found.step, 1.0 / 150.0 / 7.0, 1e-12);
  EXPECT_NEAR(found.run.encoder.back().shaft_speed[0], 4.0 * kRatio * kRatio / kTotal, 1e-6);
}

TEST(OpenLoop, HoldsTheLastTorqueWhereOneIsMissing) {
  msgs::RunLog gap = record(251, 4.0, 0.0, 0.0);
  gap.torque.erase(gap.torque.begin() + 100, gap.torque.begin() + 103);
  const OpenLoopRun found = simulate_open_loop(rigid_axis(), {}, gap, 1e-3, 9);
  ASSERT_EQ(found.remarks.size(), 1u);
  EXPECT_EQ(found.remarks[0].rfind("3 of 251 ENCODER", 0), 0u) << found.remarks[0];
  EXPECT_NEAR(found.run.encoder.back().shaft_speed[0], 4.0 * kRatio * kRatio / kTotal, 1e-9);
}

TEST(OpenLoop, TheDrivesTorqueLimitHolds) {
  sim::MachineFile file = rigid_axis();
  file.drive_protection.torque_limit = 3.0;
  const OpenLoopRun found = simulate_open_loop(file, {}, record(251, 4.0, 0.0, 0.0), 1e-3, 9);
  EXPECT_NEAR(found.run.encoder.back().shaft_speed[0], 3.0 * kRatio * kRatio / kTotal, 1e-9);
}

// In motion on an elastic transmission nothing rings: it begins wound up by what accelerates the load.
TEST(OpenLoop, AnElasticAxisBeginsWoundUp) {
  sim::MachineFile file = rigid_axis();
  sim::DriveParameters& drive = file.parameters.drive;
  drive.is_rigid = false;
  drive.gearbox_stiffness = 2e5;
  drive.gear_damping_ratio = 0.05;
  drive.gearbox_play = 1e-3;
  const OpenLoopRun found = simulate_open_loop(file, {}, record(251, 4.0, 30.0, -20.0), 1e-3, 9);
  const double acceleration = 4.0 * kRatio * kRatio / kTotal;
  for (std::size_t k = 0; k < found.run.encoder.size(); k += 10) {
    EXPECT_NEAR(found.run.encoder[k].shaft_speed[0], -20.0 + acceleration * 0.004 * static_cast<double>(k), 1e-6) << k;
  }
}

TEST(OpenLoop, RefusesWhatDoesNotFit) {
  msgs::RunLog two = record(3, 1.0, 0.0, 0.0);
  for (msgs::Encoder& encoder : two.encoder) {
    encoder.group_count = 2;
    encoder.shaft_position = encoder.shaft_speed = {0.0, 0.0};
  }
  EXPECT_THROW(simulate_open_loop(rigid_axis(), {}, two, 1e-3, 9), std::invalid_argument);
  msgs::RunLog silent = record(3, 1.0, 0.0, 0.0);
  silent.torque.clear();
  EXPECT_THROW(simulate_open_loop(rigid_axis(), {}, silent, 1e-3, 9), std::invalid_argument);
}

}  // namespace
}  // namespace slewlab::tools
