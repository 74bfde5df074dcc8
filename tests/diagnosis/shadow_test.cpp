#include "diagnosis/shadow.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <random>
#include <unsupported/Eigen/FFT>
#include <vector>

#include "diagnosis/admit.h"
#include "diagnosis/decimation.h"
#include "diagnosis/parameters_alone.h"
#include "tests/diagnosis/bench.h"

namespace slewlab::diagnosis {
namespace {

// A log of the truth's machine whose recorder was switched on in the midst of a slew, as the nominal one is fitted to it.
struct BegunInMotion : Problem {
  explicit BegunInMotion(const sim::MachineSettings& truth) {
    constexpr std::size_t kFrom = 6500;  // messages
    msgs::RunLog log = simulated_log(truth, bench().controller, kThereAndBack, kDuration, 5);
    leave_out_beginning(log, kFrom);
    log.operator_moves.clear();
    sim::MachineSettings nominal_machine;
    nominal_machine.crane = bench().crane;
    std::vector<Record> logs{make_record(log, "log", bench().admission)};
    EXPECT_TRUE(logs[0].begins_in_motion);
    EXPECT_GT(std::fabs(logs[0].shaft_position[0][0]), 10.0);  // [rad] of the motor
    set_machine(nominal_machine, logs, *this);
    std::vector<std::string> remarks;
    admit(std::move(logs), thresholds.whitening, *this, remarks);
  }
  // What nobody knows of the beginning is fitted from the truth's effects on.
  FitResult fit_of(const std::vector<common::EffectInstance>& effects) {
    Point point;
    point.nuisance.assign(nuisance_count(*this), 0.0);
    point.effects = effects;
    FitResult fitted = fit(*this, Eigen::MatrixXd::Zero(difference_count(*this), static_cast<Eigen::Index>(point.nuisance.size())), point);
    settle(*this, fitted, 4);
    return fitted;
  }
};

// Encoders that read 7 % too little: begun in the midst of a slew, the motors turn faster than they say, and their first readings are what they say of where they are.
TEST(Shadow, BeginsAsFastAsTheMachineTurnsThatIsReadWrong) {
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  truth.effects = {{"encoder_scale", {-0.07}}};
  BegunInMotion begun(truth);
  const FitResult fitted = begun.fit_of(truth.effects);
  EXPECT_LT(mean_square(fitted.difference), 1.2);
  EXPECT_NEAR(fitted.point.effects[0].values[0], -0.07, 0.006);  // its prior of a hundredth draws it to 0
}

// A machine whose pinions' mesh is where the house stands: begun in the midst of a slew, a record has the mesh of that angle and not of zero, and
// its first readings are those of its first moment.
TEST(Shadow, WhatGoesWithTheAngleHasItsPhaseInARecordThatBeginsElsewhere) {
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  truth.effects = {{"pinion_mesh_variation", {0.1, 1.0, 1.0, 0.2, 0.0, 0.0}}};
  BegunInMotion problem(truth);
  const FitResult with_mesh = problem.fit_of(truth.effects);
  EXPECT_LT(mean_square(with_mesh.difference), 1.3);  // 1 is noise alone
  EXPECT_NEAR(with_mesh.point.effects[0].values[0], 0.1, 0.005);
  EXPECT_NEAR(with_mesh.point.effects[0].values[1], 1.0, 0.05);
  EXPECT_GT(mean_square(fit_parameters_alone(problem, nominal_fit(problem)).difference), 5.0);
}

// Encoders that read 13 ms late say 13 ms later where a machine stood when the record began in the midst of a slew; it is followed to the noise, 1, from there on.
TEST(Shadow, LateEncodersSayLaterWhereARecordInMotionBegins) {
  constexpr double kDelay = 0.0128;  // [s]
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  truth.effects = {{"encoder_delay", {kDelay}}};
  const FitResult fitted = BegunInMotion(truth).fit_of(truth.effects);
  EXPECT_LT(mean_square(fitted.difference), 1.2);
  EXPECT_NEAR(fitted.point.effects[0].values[0], kDelay, 1e-4);
}

// A vessel's roll has the phase of the log's clock, not of the moment at which its recorder was switched on: followed to the noise, with the phase that it was given.
TEST(Shadow, ARollKeepsThePhaseOfTheLogsClock) {
  constexpr double kPhase = 0.7;  // [rad]
  sim::MachineSettings truth;
  truth.crane = bench().crane;
  truth.effects = {{"vessel_roll", {0.005, 9.0, kPhase, 1.5, 15.0}}};
  const FitResult fitted = BegunInMotion(truth).fit_of(truth.effects);
  EXPECT_LT(mean_square(fitted.difference), 1.3);
  EXPECT_NEAR(fitted.point.effects[0].values[2], kPhase, 0.1);
}

// White noise of an encoder keeps its power when it is read parts of a period later: a line between two readings would leave cos^2(pi / 4) = 0.5 of it at
// a quarter of the sampling rate, Lagrange's polynomial through sixteen points 0.67 of it at 0.4 of that rate, up to which encoders are judged; through 64 it leaves 0.98 there
// (the square of the sum of its weights with their phases).
TEST(Shadow, ReadingAnEncoderLaterKeepsItsNoise) {
  sim::MachineSettings machine;
  machine.crane = bench().crane;
  machine.crane.drive.gearbox_play = machine.crane.drive.pinion_play = 0.0;
  constexpr std::size_t kCount = 8192;
  constexpr double kPeriod = 0.01;  // [s]
  Record record;
  record.step = record.encoder_period = kPeriod;
  record.group_count = 2;
  std::mt19937 generator(3);
  std::normal_distribution<double> normal;
  for (std::size_t g = 0; g < 2; ++g) {
    for (auto* series : {&record.motor_torque[g], &record.shaft_speed[g], &record.shaft_position[g], &record.position_rate[g]}) series->assign(kCount, 0.0);
    for (double& value : record.shaft_position[g]) value = 1e-4 * normal(generator);
  }
  const ShadowGains gains = shadow_gains(bench().machine.scales, not_faster_than(bench().thresholds.shadow, kPeriod));
  const auto power = [&](double latency, double from, double to) {
    std::vector<double> missing = shadow(machine, record, gains, latency).missing_torque[0];
    std::vector<std::complex<double>> spectrum;
    Eigen::FFT<double>().fwd(spectrum, missing);
    double sum = 0.0;
    for (auto k = static_cast<std::size_t>(from * kPeriod * kCount); k < static_cast<std::size_t>(to * kPeriod * kCount); ++k) sum += std::norm(spectrum[k]);
    return sum;
  };
  for (const auto& [from, to] : {std::pair{20.0, 33.0}, {36.0, 40.0}}) {  // [Hz]
    EXPECT_NEAR(power(0.5 * kPeriod, from, to) / power(0.0, from, to), 1.0, 0.03) << from;
    EXPECT_NEAR(power(-0.3 * kPeriod, from, to) / power(0.0, from, to), 1.0, 0.03) << from;
  }
}

// Encoders that are read once in so many commands: the machine gets each of these, so that a law of no size, which acts on commands, changes nothing.
TEST(Shadow, GetsEachCommandBetweenTwoReadings) {
  constexpr std::size_t kCommands = 20;
  sim::MachineSettings nominal;
  nominal.crane = bench().crane;
  Record record = make_record(simulated_log(nominal, bench().controller, kThereAndBack, 20.0, 4), "a", bench().admission);
  const std::size_t rows = record.size() / kCommands;
  const auto thin = [&](std::vector<double>& series) {
    for (std::size_t n = 0; n < rows && !series.empty(); ++n) series[n] = series[n * kCommands];
    series.resize(series.empty() ? 0 : rows);
  };
  for (std::size_t g = 0; g < 2; ++g) {
    record.recorded_torque[g].assign(record.motor_torque[g].begin(), record.motor_torque[g].begin() + static_cast<std::ptrdiff_t>(rows * kCommands));
    record.motor_torque[g] = means(record.recorded_torque[g], kCommands);
    for (std::vector<double>* series : {&record.shaft_speed[g], &record.shaft_position[g], &record.position_rate[g]}) thin(*series);
  }
  for (std::vector<double>& series : record.acceleration) thin(series);
  record.recorded_per_point = kCommands;
  record.step = record.encoder_period = kCommands * kStep;
  sim::MachineSettings with_none = nominal;
  with_none.effects = {{"uneven_motor_torque", {0.0, 0.0}}};
  const Shadow alone = shadow(nominal, record, bench_gains()), beside = shadow(with_none, record, bench_gains());
  for (std::size_t n = 0; n < rows; ++n) ASSERT_NEAR(alone.missing_torque[0][n], beside.missing_torque[0][n], 1e-6) << n;  // [Nm]
}

// What is missing at the motors is as much more as the drives would deliver where they were told so; what was delivered for it is missing less.
TEST(Shadow, MoreTorqueAtTheMotorsIsWhatAsMuchMoreFromTheDrivesIs) {
  sim::MachineSettings nominal;
  nominal.crane = bench().crane;
  const Record record = make_record(simulated_log(nominal, bench().controller, kThereAndBack, kDuration, 4), "a", bench().admission);
  const DriveCourse course = drive_course(record, nominal.drive_protection);
  ASSERT_EQ(course.per_point, 1U);
  std::vector<MoreTorques> torques(3);  // so many are simulated side by side
  std::vector<DriveCourse> courses(3, course);
  for (std::size_t k = 0; k < torques.size(); ++k) {
    for (std::size_t g = 0; g < 2; ++g) {
      for (std::size_t n = 0; n < record.size(); ++n) {
        torques[k].of_group[g].push_back(static_cast<double>(k) * std::sin(1e-3 * static_cast<double>((g + 1) * n)));  // [Nm]
        courses[k].motor_torque[g][n] += torques[k].of_group[g].back();
      }
    }
  }
  const Follower follower = follower_of(nominal, grid_of(record));
  std::vector<Shadow> pushed(3), told(3);
  std::vector<Shadowing> shadowings;
  for (std::size_t k = 0; k < 3; ++k) shadowings.push_back({follower, 0.0, {}, &pushed[k], {&torques[k]}});
  shadow(std::move(shadowings), record, course, bench_gains());
  for (std::size_t k = 0; k < 3; ++k) shadow({{follower, 0.0, {}, &told[k]}}, record, courses[k], bench_gains());
  constexpr double kRounding = 1e-8;  // [Nm], [m/s^2]
  double largest = 0.0;
  for (std::size_t n = 0; n < record.size(); ++n) {
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t g = 0; g < 2; ++g) ASSERT_NEAR(pushed[k].missing_torque[g][n], told[k].missing_torque[g][n], kRounding) << k << " at " << n;
      ASSERT_NEAR(pushed[k].acceleration_difference[kTip][n], told[k].acceleration_difference[kTip][n], kRounding) << k << " at " << n;
    }
    largest = std::max(largest, std::fabs(pushed[2].missing_torque[0][n] - pushed[0].missing_torque[0][n]));
  }
  EXPECT_GT(largest, 0.5) << "[Nm] of two";
}

// A constant torque on the house is what the effect of that name is, from the first moment on, at which the gears that hold it are wound up. One that comes and goes winds them up and
// lets them go, as it does not at the motors.
TEST(Shadow, MoreTorqueOnTheHouseIsWhatPushesIt) {
  constexpr double kTorque = 1.5e5;  // [Nm]
  sim::MachineSettings nominal;
  nominal.crane = bench().crane;
  sim::MachineSettings pushed = nominal;
  pushed.effects = {{"torque_offset", {kTorque}}};
  Record record = make_record(simulated_log(pushed, bench().controller, {{22.0, 0.5}, {30.0, 0.0}}, 42.0, 5), "a", bench().admission);
  leave_out_beginning(record, 20000);
  record.begins_on_flanks = true;
  MoreTorques torques;
  torques.is_on_house = true;
  const Follower follower = follower_of(nominal, grid_of(record));
  for (std::size_t g = 0; g < 2; ++g) torques.of_group[g].assign(record.size(), 0.5 * kTorque / follower.to_slew_axis);
  const DriveCourse course = drive_course(record, nominal.drive_protection);
  Shadow by_effect, by_torque, on_house, at_motors;
  shadow({{follower_of(pushed, grid_of(record)), 0.0, {}, &by_effect}}, record, course, bench_gains());
  shadow({{follower, 0.0, {}, &by_torque, {&torques}}}, record, course, bench_gains());
  for (std::size_t g = 0; g < 2; ++g) {
    for (std::size_t n = 0; n < record.size(); ++n) torques.of_group[g][n] *= std::sin(3.0 * record.step * static_cast<double>(n));
  }
  shadow({{follower, 0.0, {}, &on_house, {&torques}}}, record, course, bench_gains());
  torques.is_on_house = false;
  shadow({{follower, 0.0, {}, &at_motors, {&torques}}}, record, course, bench_gains());
  double largest = 0.0, apart = 0.0;
  for (std::size_t n = 0; n < record.size(); ++n) {
    ASSERT_NEAR(by_torque.missing_torque[0][n], by_effect.missing_torque[0][n], 1e-7) << n;
    largest = std::max(largest, std::fabs(by_effect.missing_torque[0][n]));
    apart = std::max(apart, std::fabs(at_motors.missing_torque[0][n] - on_house.missing_torque[0][n]));
  }
  EXPECT_GT(apart, 0.5) << "[Nm] while the house moves in its gears";
  EXPECT_LT(largest, 20.0) << "[Nm]: it begins as it stands";
}

// A crane on a slope, its drives on and its gears pressed since 40 s: boom and load hang as the slope has them, and so does the machine that is asked for it. One that begins unbent rings for half a minute.
TEST(Shadow, AMachineThatStandsOnASlopeBeginsBent) {
  constexpr double kSlope = 0.015;  // [rad]
  constexpr std::size_t kStood = 40000;  // readings
  sim::MachineSettings nominal;
  nominal.crane = bench().crane;
  Problem problem;
  set_machine(nominal, {}, problem);
  Point sloping;
  sloping.effects = {common::typical_instance(problem.catalogue.at("heel"))};
  sloping.effects.front().values[common::kSize] = kSlope;
  sim::MachineSettings truth = nominal;
  truth.effects = sloping.effects;
  std::vector<Record> records;
  records.push_back(make_record(simulated_log(truth, bench().controller, {{42.0, 0.5}, {50.0, 0.0}}, 62.0, 3), "a", bench().admission));
  leave_out_beginning(records.front(), kStood);
  set_machine(nominal, records, problem);
  std::vector<std::string> remarks;
  admit(std::move(records), problem.thresholds.whitening, problem, remarks);
  ASSERT_TRUE(problem.records[0].begins_on_flanks);
  ASSERT_FALSE(problem.records[0].begins_bent);
  EXPECT_GT(mean_square(differences(problem, Point{})), 10.0) << "the slope shows";
  EXPECT_LT(mean_square(differences(problem, sloping)), 1.3);
}

// A standing machine in the midst of its play, whose motors stand elsewhere in it than in the middle: they do so from the first moment on, and nothing has to push them there.
TEST(Shadow, MotorsBeginWhereTheyStandInTheirPlay) {
  sim::MachineSettings machine;
  machine.crane = bench().crane;
  constexpr std::size_t kCount = 200;
  Record record;
  record.step = record.encoder_period = 1e-2;
  record.group_count = 2;
  for (std::size_t g = 0; g < 2; ++g) {
    for (auto* series : {&record.motor_torque[g], &record.shaft_speed[g], &record.shaft_position[g], &record.position_rate[g]}) series->assign(kCount, 0.0);
  }
  Beginning beginning;
  const double place = 0.5 * sim::gear_contact(machine.crane).half_play;
  beginning.motor_offset = {place, -place};
  const Shadow follower = shadow(machine, record, bench_gains(), 0.0, beginning);
  for (std::size_t g = 0; g < 2; ++g) {
    for (const double missing : follower.missing_torque[g]) EXPECT_NEAR(missing, 0.0, 1e-9);
  }
}

}  // namespace
}  // namespace slewlab::diagnosis
