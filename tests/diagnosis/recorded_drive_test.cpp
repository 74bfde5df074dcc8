// What the drive makes of recorded commands is what it made of them in the run that was recorded, and a machine judged
// against its own file has no gap, whatever its drive's protection.
#include "diagnosis/recorded_drive.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "diagnosis/prediction.h"
#include "tests/diagnosis/bench.h"

namespace slewlab::diagnosis {
namespace {

// Low enough to act on the bench's manoeuvres, which ask for some 60 Nm per motor.
sim::DriveProtectionSettings weak_drive() {
  sim::DriveProtectionSettings protection;
  protection.torque_limit = 45.0;
  return protection;
}
sim::DriveProtectionSettings slow_drive() {
  sim::DriveProtectionSettings protection;
  protection.torque_rate_limit = 30.0;  // [Nm/s]
  return protection;
}
sim::DriveProtectionSettings braked_drive() {  // the brakes of config/cranes/thesis.yaml
  sim::DriveProtectionSettings protection;
  protection.standstill_speed = 1.0;
  protection.brake = {.torque = 400.0, .closing_delay = 80'000'000, .closing_time_constant = 0.06,
                      .release_delay = 100'000'000, .release_time_constant = 0.06};
  return protection;
}

// The bench's controller as a PLC program that brakes at standstill.
controller::Compute braking_at_standstill() {
  controller::ControllerSettings settings = bench().controller;
  settings.period = kStep;
  return [compute = controller::computed_answer(settings)](const msgs::Encoder& encoder, const msgs::Operator& operator_move,
                                                           msgs::Torque& torque, msgs::ControllerState& state) {
    compute(encoder, operator_move, torque, state);
    if (state.mode != static_cast<std::int8_t>(controller::Mode::stopped)) return;
    torque.brake = true;
    torque.enable = false;
  };
}

sim::MachineSettings machine_with(const sim::DriveProtectionSettings& protection) {
  sim::MachineSettings machine;
  machine.crane = bench().crane;
  machine.step = kStep;
  machine.drive_protection = protection;
  return machine;
}

// A run, and what its drive did in every step.
struct DrivenLog {
  msgs::RunLog log;
  std::vector<sim::GroupArray> torque;  // [Nm per motor] at the machine
  std::vector<double> brake;            // [Nm per motor] at the end of the step
};

DrivenLog run(const sim::DriveProtectionSettings& protection, controller::Compute compute) {
  DrivenLog result;
  const sim::MachineSettings machine = machine_with(protection);
  LoopCourse course;
  course.plant_step = kStep;
  course.steps = 12'000;
  for (const Move& move : kThereAndBack) course.operator_moves.push_back({.time = std::llround(move.time * 1e9), .speed_request = move.speed_request});
  sim::CranePlant plant(machine, drive_run(course, machine.crane.drive.group_count));
  ControllerAnswer answer(std::move(compute));
  LoopHooks hooks;
  hooks.answered = [&](const LoopMoment& moment) {
    result.log.encoder.push_back(moment.encoder);
    result.log.torque.push_back(answer.torque());
  };
  hooks.stepped = [&](const LoopMoment&) {
    result.torque.push_back(plant.machine().applied_torque);
    result.brake.push_back(plant.drive().brake.torque);
  };
  run_loop(course, plant, std::ref(answer), hooks);
  return result;
}

controller::Compute plain() {
  controller::ControllerSettings settings = bench().controller;
  settings.period = kStep;
  return controller::computed_answer(settings);
}

void expect_the_drive_of_the_run(const sim::DriveProtectionSettings& protection, const DrivenLog& run) {
  const Record record = make_record(run.log, "log", bench().admission);
  RecordedDrive drive(record, protection);
  std::size_t limited = 0;
  for (std::size_t n = 0; n < record.size(); ++n) {
    const sim::DriveCommand command = drive.next();
    for (std::size_t g = 0; g < 2; ++g) {
      ASSERT_EQ(command.motor_torque[g], run.torque[n][g]) << n;
      if (command.motor_torque[g] != record.motor_torque[g][n]) ++limited;
    }
    // The command has the brake's mean over the step, the run its value at the end: apart by a step's share of the time constant.
    ASSERT_NEAR(command.brake_torque[0], run.brake[n], 400.0 * kStep / 0.06) << n;
  }
  EXPECT_GT(limited, 500u) << "the drive must act for the test to say anything";
}

TEST(RecordedDrive, LimitsTheTorqueAsTheRunsDid) { expect_the_drive_of_the_run(weak_drive(), run(weak_drive(), plain())); }

TEST(RecordedDrive, LimitsTheRateAsTheRunsDid) { expect_the_drive_of_the_run(slow_drive(), run(slow_drive(), plain())); }

TEST(RecordedDrive, BrakesAsTheRunsDid) {
  expect_the_drive_of_the_run(braked_drive(), run(braked_drive(), braking_at_standstill()));
}

TEST(RecordedDrive, AProtectionThatDoesNotActChangesNoBit) {
  const DrivenLog one = run({}, plain());
  const Record record = make_record(one.log, "log", bench().admission);
  RecordedDrive drive(record, {});
  for (std::size_t n = 0; n < record.size(); ++n) {
    const sim::DriveCommand command = drive.next();
    ASSERT_EQ(command.motor_torque[0], record.motor_torque[0][n]) << n;
    ASSERT_EQ(command.brake_torque[0], 0.0);
  }
}

// A record that begins while the motors turn begins with a drive that delivers already.
TEST(RecordedDrive, BeginsInMotionWithTheFirstCommand) {
  DrivenLog one = run({}, plain());
  one.log.encoder.erase(one.log.encoder.begin(), one.log.encoder.begin() + 5000);
  one.log.torque.erase(one.log.torque.begin(), one.log.torque.begin() + 5000);
  const Record record = make_record(one.log, "log", bench().admission);
  ASSERT_GT(std::fabs(record.motor_torque[0][0]), 10.0) << "in the ramp";
  EXPECT_EQ(RecordedDrive(record, slow_drive()).next().motor_torque[0], record.motor_torque[0][0]);
}

TEST(RecordedDrive, TripsWherePlantStatusSaysSoUntilItIsAcknowledged) {
  const DrivenLog one = run({}, plain());
  Record record = make_record(one.log, "log", bench().admission);
  msgs::PlantStatus status{};
  status.simulated_time = 4'000'000'000;
  status.drive_state = static_cast<std::int8_t>(sim::DriveState::tripped);
  status.trip_cause = static_cast<std::int8_t>(sim::DriveFault::power_lost);
  record.plant_status.push_back(status);
  record.torque[6000].acknowledge = true;
  RecordedDrive drive(record, braked_drive());
  for (std::size_t n = 0; n < record.size(); ++n) {
    const sim::DriveCommand command = drive.next();
    const bool tripped = n >= 4000 && n < 6001;  // torque flows from the message behind the acknowledgement on
    if (tripped) {
      ASSERT_EQ(command.motor_torque[0], 0.0) << n;
    } else {
      ASSERT_EQ(command.motor_torque[0], record.motor_torque[0][n]) << n;
    }
    if (n == 5000) {
      EXPECT_NEAR(command.brake_torque[0], 400.0, 1.0);
    }
  }
}

TEST(RecordedDrive, SaysInWhichShareOfAGridStepTheMotorsAreEnabled) {
  DriveCourse course;
  course.per_point = 2;
  course.enable = {true, true, true, false, false, false};
  EXPECT_EQ(enabled_share(course, 0), 1.0);
  EXPECT_EQ(enabled_share(course, 1), 0.5);
  EXPECT_EQ(enabled_share(course, 2), 0.0);
}

// The residual variance ratio (1 = noise only) of the nominal machine, nothing fitted, where its file is the truth.
double left_by_its_own_file(const sim::DriveProtectionSettings& truth, const sim::DriveProtectionSettings& told, const controller::Compute& compute) {
  sim::MachineSettings machine = machine_with(truth);
  BenchProblem problem;
  problem.nominal.drive_protection = told;
  problem.add(make_record(simulated_log(sim::make_machine(machine), compute, kThereAndBack, kDuration, 7, truth), "own", bench().admission));
  return mean_square(nominal_fit(problem).difference);
}

TEST(OwnFile, LeavesNoGapWhateverTheDrivesProtection) {
  EXPECT_LT(left_by_its_own_file({}, {}, plain()), 1.2);
  EXPECT_LT(left_by_its_own_file(weak_drive(), weak_drive(), plain()), 1.2);
  EXPECT_LT(left_by_its_own_file(slow_drive(), slow_drive(), plain()), 1.2);
  EXPECT_LT(left_by_its_own_file(braked_drive(), braked_drive(), braking_at_standstill()), 1.2);
}

// The test above would notice: the same machines against a file that does not speak of their drives. (What holds motors
// that stand, brakes or the observer, has the same residual.)
TEST(OwnFile, LeavesAGapWhereTheFileForgetsTheDrive) {
  EXPECT_GT(left_by_its_own_file(weak_drive(), {}, plain()), 10.0);
  EXPECT_GT(left_by_its_own_file(slow_drive(), {}, plain()), 10.0);
}

// From the operator's moves alone, down to the noise of the sensors (2e-3 rad/s of speed times the gain of 40 Nms/rad).
TEST(OwnFile, PredictsItsOwnLogThroughItsOwnDrive) {
  const sim::MachineSettings machine = machine_with(weak_drive());
  const Record record = make_record(simulated_log(machine, bench().controller, kThereAndBack, kDuration, 8), "own", bench().admission);
  for (const SignalGap& gap : predict(machine, bench().controller, record).gaps) {
    if (gap.unit == "Nm") {
      EXPECT_LT(gap.gap, 5.0 * 40.0 * 2e-3) << gap.signal;
    }
  }
  sim::MachineSettings forgetful = machine;
  forgetful.drive_protection = {};
  EXPECT_GT(predict(forgetful, bench().controller, record).gaps[0].gap, 1.0);
}

// A controller that is slower than the recorder: its commands stand for so many rows, and each of them is one message. Where they change with every row, a row is one.
TEST(MessageCycle, IsTheControllersOwn) {
  Record record;
  record.step = record.encoder_period = 0.01;
  record.group_count = 2;
  const auto written = [&](std::size_t rows, std::size_t first) {
    for (std::size_t g = 0; g < 2; ++g) {
      record.motor_torque[g].clear();
      for (std::size_t n = 0; n < 1000; ++n) record.motor_torque[g].push_back(std::sin(0.7 * static_cast<double>((n + rows - first) / rows) + static_cast<double>(g)));
    }
    return message_cycle(record);
  };
  const MessageCycle of_each = written(1, 0), of_five = written(5, 3);
  EXPECT_EQ(of_each.commands, 1u);
  for (const std::size_t n : {0u, 1u, 7u}) EXPECT_EQ(of_each.sequence(n), static_cast<std::int64_t>(n));  // as the controller numbers them: a draw goes by its message's number
  EXPECT_EQ(of_five.commands, 5u);
  EXPECT_EQ(of_five.sequence(2) + 1, of_five.sequence(3));
  EXPECT_EQ(of_five.sequence(3), of_five.sequence(7));
  EXPECT_EQ(of_five.sequence(7) + 1, of_five.sequence(8));
  for (std::vector<double>& torque : record.motor_torque) std::fill(torque.begin(), torque.end(), 3.0);
  EXPECT_EQ(message_cycle(record).commands, 1u);  // which shows nothing
}

}  // namespace
}  // namespace slewlab::diagnosis
