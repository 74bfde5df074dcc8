#include "diagnosis/controller_loop.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/diagnosis/bench.h"

namespace slewlab::diagnosis {
namespace {

constexpr double kPeriod = 5e-3;  // [s]

Record empty_record(int groups, std::size_t count) {
  Record record;
  record.name = "standing";
  record.step = record.encoder_period = kPeriod;
  record.group_count = groups;
  for (std::size_t g = 0; g < static_cast<std::size_t>(groups); ++g) {
    for (auto* series : {&record.motor_torque[g], &record.shaft_speed[g], &record.shaft_position[g], &record.position_rate[g]}) series->assign(count, 0.0);
  }
  return record;
}

// exp(-j w h) at a frequency [Hz].
std::complex<double> one_step_later(double frequency) { return std::polar(1.0, -2.0 * std::numbers::pi * frequency * kPeriod); }

// Each motor answers its own reading's change with K_p a cycle later: C = K_p (1 - z^-1) / h z^-1, of which the record has noise alone, and in its second half, where the machine stands, what was rounded. By polynomials, so within a twentieth.
TEST(ControllerLoop, FindsWhatTheControllerAnswers) {
  constexpr std::size_t kCount = 20000;
  constexpr double kGain[] = {7.0, 3.0};  // [Nms/rad]
  Record record = empty_record(2, kCount);
  std::mt19937_64 engine(3);
  std::normal_distribution<double> normal;
  for (std::size_t g = 0; g < 2; ++g) {
    for (std::size_t n = 0; n < kCount; ++n) {
      const bool stands = n > kCount / 2;
      record.shaft_position[g][n] = (stands ? 1e-15 : 1e-4) * normal(engine);
      if (stands) record.motor_torque[g][n] = 1e-12 * normal(engine);
      else if (n >= 2) record.motor_torque[g][n] = -kGain[g] * (record.shaft_position[g][n - 1] - record.shaft_position[g][n - 2]) / kPeriod;
    }
  }
  const ControllerResponse answer = controller_response(record, 2000, 8.0, 16.0);
  for (const double frequency : {2.0, 8.0, 12.0, 16.0}) {
    const std::complex<double> z = one_step_later(frequency);
    const GroupMatrix found = answer.at(frequency);
    for (Eigen::Index g = 0; g < 2; ++g) {
      const std::complex<double> expected = kGain[g] * (1.0 - z) / kPeriod * z;
      EXPECT_LT(std::abs(found(g, g) - expected), 0.05 * std::abs(expected)) << frequency << " Hz, group " << g;
      EXPECT_LT(std::abs(found(g, 1 - g)), 0.05 * std::abs(expected)) << frequency << " Hz, group " << g;
    }
  }
}

// Who does not read the encoders is no controller: of positions that never change nothing is found, and no machine stretches what is not answered.
TEST(ControllerLoop, IsNoneWhereNothingIsRead) {
  const ControllerResponse answer = controller_response(empty_record(2, 20000), 2000, 8.0, 16.0);
  EXPECT_TRUE(answer.rate.empty());
  Whitening whitening;
  whitening.bin_count = 3;
  EXPECT_EQ(stretch_of_readings({}, answer, whitening).squaredNorm(), 0.0);
}

// An axis whose gear gives: the motor J_m with the table J_t behind its stiffness k turns like one inertia of J_m + J_t / (1 - J_t w^2 / k). A torque that is held for a step h turns that by
// P = h^2 / 2 J z^-1 (1 + z^-1) / (1 - z^-1)^2. Its damping, a twentieth of the critical one, changes little far from the modes at 10 and 24 Hz.
TEST(ControllerLoop, KnowsTheMachineByWhatItTurns) {
  sim::MachineSettings axis;
  axis.crane = sim::load_machine_file(SLEWLAB_SOURCE_DIR "/config/axes/example_axis.yaml").parameters;
  const sim::MachineDescription described = sim::describe(axis.crane);
  constexpr double kRatio = 80.0, kMotor = 0.0015, kTable = 40.0 / (kRatio * kRatio), kStiffness = 150e3 / (kRatio * kRatio);  // as the file has them, on the motor's shaft
  Record record = empty_record(1, 20000);
  record.step = record.encoder_period = 1e-3;
  const MachineResponse response = machine_response(axis, record, shadow_gains(described.scales, thresholds_of(described).shadow), 0.0, 16000, {});
  for (const double frequency : {0.5, 2.0, 150.0}) {
    const double angular = 2.0 * std::numbers::pi * frequency;  // [rad/s]
    const double inertia = kMotor + kTable / (1.0 - kTable * angular * angular / kStiffness);
    const std::complex<double> z = std::polar(1.0, -angular * record.step);
    const std::complex<double> expected = record.step * record.step / (2.0 * inertia) * z * (1.0 + z) / ((1.0 - z) * (1.0 - z));
    const std::complex<double> found = response.at[static_cast<std::size_t>(std::lround(frequency / response.bin_width))](0, 0);
    EXPECT_LT(std::abs(found - expected), 0.02 * std::abs(expected)) << frequency << " Hz";
  }
}

// exp(-j w d) P, whether the encoders' latency is the record's or an effect.
TEST(ControllerLoop, ReadsLateByLatencyAsByAnEffect) {
  sim::MachineSettings machine;
  machine.crane = bench().crane;
  const Record record = empty_record(2, 20000);
  constexpr double kLate = 0.012;  // [s]
  const MachineResponse in_time = machine_response(machine, record, bench_gains(), 0.0, 2000, {}), late = machine_response(machine, record, bench_gains(), kLate, 2000, {});
  machine.effects = {{"encoder_delay", {kLate}}};
  const MachineResponse by_effect = machine_response(machine, record, bench_gains(), 0.0, 2000, {});
  for (std::size_t k = 1; k < in_time.at.size(); k += 50) {
    const std::complex<double> turned = std::polar(1.0, -2.0 * std::numbers::pi * static_cast<double>(k) * in_time.bin_width * kLate);
    const double near = 1e-9 * in_time.at[k].norm();
    EXPECT_LT((late.at[k] - turned * in_time.at[k]).norm(), near) << k;
    EXPECT_LT((by_effect.at[k] - late.at[k]).norm(), near) << k;
  }
}

// (1 + e) P: encoders that read too much by the share e read so much more of what a torque turns. From 5 Hz on, for the load swings longer than the transform is, to 40 Hz, which are judged.
TEST(ControllerLoop, ReadsByAnEncodersScale) {
  sim::MachineSettings machine;
  machine.crane = bench().crane;
  const Record record = empty_record(2, 20000);
  constexpr double kError = 0.05;
  const MachineResponse as_it_is = machine_response(machine, record, bench_gains(), 0.0, 2000, {});
  machine.effects = {{"encoder_scale", {kError}}};
  const MachineResponse read = machine_response(machine, record, bench_gains(), 0.0, 2000, {});
  for (double frequency = 5.0; frequency <= 40.0; frequency += 5.0) {
    const auto k = static_cast<std::size_t>(std::lround(frequency / as_it_is.bin_width));
    EXPECT_LT((read.at[k] - (1.0 + kError) * as_it_is.at[k]).norm(), 1e-3 * as_it_is.at[k].norm()) << frequency << " Hz";
  }
}

// The bench's machine stands without play in the loop of a stiff controller, whose only trouble is the encoders' noise. Readings that are taken a few milliseconds later, or torques that come
// later, have a smaller residual than the truth. By what the loop makes of the readings none of them is likelier.
TEST(ControllerLoop, OfNoiseAloneNoDelayIsLikelier) {
  constexpr std::size_t kCount = 36000;
  constexpr double kRate = 60.0;  // [1/s] of the speed controller, against the motors alone
  BenchProblem problem;
  problem.nominal.crane.drive.gearbox_play = problem.nominal.crane.drive.pinion_play = 0.0;
  problem.gains = shadow_gains(bench().machine.scales, not_faster_than(bench().thresholds.shadow, kPeriod));
  Record record = empty_record(2, kCount);
  const Follower truth = linear_follower(problem.nominal, grid_of(record), {});
  sim::Machine machine = truth.machine;
  const double gain = kRate * bench().machine.scales.motor_inertia;  // [Nms/rad]
  std::mt19937_64 engine(11);
  std::normal_distribution<double> normal;
  for (std::size_t n = 0; n < kCount; ++n) {
    const sim::MachineReadings readings = sim::read(machine);
    sim::DriveCommand command;
    for (std::size_t g = 0; g < 2; ++g) {
      record.shaft_position[g][n] = readings.shaft_position[g] + 1e-3 * normal(engine);
      if (n > 0) command.motor_torque[g] = -gain * (record.shaft_position[g][n] - record.shaft_position[g][n - 1]) / kPeriod;
      record.motor_torque[g][n] = command.motor_torque[g];
    }
    for (int step = 0; step < truth.steps; ++step) sim::step(machine, command);
  }
  problem.add(record);
  const ControllerLoop loop = controller_loop(problem);
  Point truth_itself;
  truth_itself.nuisance.assign(nuisance_count(problem), 0.0);
  std::vector<Point> late_ones;
  for (const double late : {-6e-3, -4e-3, -2e-3, -5e-4, 5e-4, 2e-3, 4e-3, 6e-3}) {
    late_ones.push_back(truth_itself);
    late_ones.back().nuisance[problem.nuisances.parameters.size()] = late / problem.nuisances.latency_deviation;
  }
  for (const char* const effect : {"encoder_delay", "dead_time", "torque_lag"}) {
    late_ones.push_back(truth_itself);
    late_ones.back().effects = {common::typical_instance(problem.catalogue.at(effect))};
    late_ones.back().effects[0].values[0] = 3e-3;  // [s]
  }
  const double of_truth = differences(problem, truth_itself).squaredNorm();
  double least = of_truth;
  for (const Point& point : late_ones) {
    const double left = differences(problem, point).squaredNorm();
    EXPECT_GT(left + loss_by_loop(problem, loop, point), of_truth) << (point.effects.empty() ? "latency" : point.effects[0].name) << ", left " << left;
    least = std::min(least, left);
  }
  EXPECT_LT(least, 0.9 * of_truth) << "else nothing is shown";
}

}  // namespace
}  // namespace slewlab::diagnosis
