#include "diagnosis/judged_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <random>
#include <unsupported/Eigen/FFT>
#include <vector>

#include "diagnosis/recorded_drive.h"
#include "tests/diagnosis/bench.h"

namespace slewlab::diagnosis {
namespace {

constexpr double kHighest = 40.0;  // [Hz] of the band; 1 / (4.5 40 Hz) is 5.6 ms

// 20 s at 1 kHz of two groups that stand, with the tip's accelerometer.
Record at_1_khz(double encoder_period = 1e-3) {
  constexpr std::size_t kCount = 20001;
  Record record;
  record.step = record.sensor_period = 1e-3;
  record.encoder_period = encoder_period;
  record.group_count = 2;
  for (std::size_t g = 0; g < 2; ++g) {
    for (auto* series : {&record.motor_torque[g], &record.shaft_speed[g], &record.shaft_position[g], &record.position_rate[g]}) series->assign(kCount, 0.0);
  }
  record.acceleration[kTip].assign(kCount, 0.0);
  return record;
}

double sine(double frequency, double time) { return std::sin(2.0 * std::numbers::pi * frequency * time + 0.3); }

TEST(JudgedGrid, HoldsTheBandFourAndAHalfTimesAndNoMore) {
  EXPECT_EQ(points_per_judged_point(at_1_khz(), kHighest), 5U);
  EXPECT_EQ(points_per_judged_point(at_1_khz(), 2.0 * kHighest), 2U);
  EXPECT_EQ(points_per_judged_point(at_1_khz(), 200.0), 1U);
  Record slow = at_1_khz(1e-2);
  slow.step = 1e-2;
  EXPECT_EQ(points_per_judged_point(slow, kHighest), 1U);
}

TEST(JudgedGrid, KeepsReadingsOfTheEncodersOnIt) {
  EXPECT_EQ(points_per_judged_point(at_1_khz(1e-2), kHighest), 5U);  // two points from reading to reading
  EXPECT_EQ(points_per_judged_point(at_1_khz(4e-3), kHighest), 4U);
  EXPECT_EQ(points_per_judged_point(at_1_khz(7e-3), kHighest), 1U);  // none but every point holds readings every 7 ms
  EXPECT_EQ(points_per_judged_point(at_1_khz(2e-3), kHighest), 4U);
  Record record = at_1_khz(1e-2);
  for (std::size_t n = 0; n < record.size(); ++n) record.shaft_position[0][n] = std::pow(1e-3 * static_cast<double>(n), 3.0);
  const Record judged = on_judged_grid(record, kHighest);
  for (std::size_t n = 0; n < judged.size(); ++n) EXPECT_EQ(judged.shaft_position[0][n], record.shaft_position[0][5 * n]);
}

TEST(JudgedGrid, LeavesAsTheyAreSensorsBesideItAndCoarseCounts) {
  Record beside = at_1_khz();
  beside.sampled_at = {0, 1};
  EXPECT_EQ(points_per_judged_point(beside, kHighest), 1U);
  Record coarse = at_1_khz();
  coarse.encoder_quantum = kCoarseCount;
  EXPECT_EQ(points_per_judged_point(coarse, kHighest), 1U);
  const Record same = on_judged_grid(coarse, kHighest);
  EXPECT_EQ(same.size(), coarse.size());
  EXPECT_FALSE(same.noise);
}

// The band keeps its size and its time, also of a position that rises all along; what would fold into it from above is gone.
TEST(JudgedGrid, KeepsTheBandAndNothingFoldsIntoIt) {
  for (const double frequency : {0.5, 5.2, 20.0, 39.0, 170.0, 199.0, 237.0}) {
    Record record = at_1_khz();
    for (std::size_t n = 0; n < record.size(); ++n) {
      const double time = record.time(n);
      record.acceleration[kTip][n] = sine(frequency, time);
      record.shaft_position[0][n] = 3.0 * time + sine(frequency, time);
    }
    const Record judged = on_judged_grid(record, kHighest);
    EXPECT_DOUBLE_EQ(judged.step, 5e-3);
    EXPECT_EQ(judged.size(), 4001U);
    for (std::size_t n = 20; n + 20 < judged.size(); ++n) {
      const double expected = frequency <= kHighest ? sine(frequency, judged.time(n)) : 0.0;
      ASSERT_NEAR(judged.acceleration[kTip][n], expected, 1e-3) << frequency;
      ASSERT_NEAR(judged.shaft_position[0][n] - 3.0 * judged.time(n), expected, 1e-3) << frequency;
    }
    EXPECT_NEAR(judged.shaft_position[0].front(), record.shaft_position[0].front(), 1e-9) << "a rise is not shifted where it begins";
  }
}

// What a motor is given in torque times time stays, each command is kept, and one that holds keeps its bits.
TEST(JudgedGrid, KeepsEveryCommandAndTheMeanOfThem) {
  Record record = at_1_khz(2e-3);
  for (std::size_t n = 0; n < record.size(); ++n) record.motor_torque[0][n] = n < 10000 ? 0.1 * static_cast<double>((n / 2) % 7) : 12.3;
  const Record judged = on_judged_grid(record, kHighest);
  EXPECT_EQ(judged.recorded_per_point, 4U);
  EXPECT_DOUBLE_EQ(command_step(judged), 1e-3);
  for (std::size_t n = 0; n < record.size(); ++n) ASSERT_EQ(commands(judged, 0)[n], record.motor_torque[0][n]);
  const auto sum = [](const std::vector<double>& values, std::size_t count) { return std::accumulate(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count), 0.0); };
  EXPECT_NEAR(4.0 * sum(judged.motor_torque[0], 5000), sum(record.motor_torque[0], 20000), 1e-6);
  EXPECT_EQ(judged.motor_torque[0].back(), 12.3);

  Record cut = judged;
  leave_out_beginning(cut, 100);
  EXPECT_EQ(cut.size(), judged.size() - 100);
  EXPECT_EQ(commands(cut, 0).front(), commands(judged, 0)[400]);
  EXPECT_EQ(commands(cut, 0).size(), cut.size() * 4);

  // The drives' course has them all, limited one by one.
  sim::DriveProtectionSettings protection;
  protection.torque_limit = 0.35;  // [Nm]
  const DriveCourse course = drive_course(judged, protection);
  EXPECT_EQ(course.per_point, 4U);
  ASSERT_EQ(course.motor_torque[0].size(), judged.size() * 4);
  for (std::size_t n = 100; n < 9000; ++n) ASSERT_EQ(course.motor_torque[0][n], std::min(0.35, record.motor_torque[0][n]));
}

// White noise of the readings has the same power in the band whatever grid it is on: on the judged one, that of its variance there as if it were white.
TEST(JudgedGrid, TellsTheNoiseFromTheReadingsAsTheyWere) {
  constexpr double kEncoder = 1e-4, kAccelerometer = 0.02;  // [rad], [m/s^2]
  Record record = at_1_khz();
  std::mt19937_64 engine(7);
  std::normal_distribution<double> normal;
  for (double& value : record.shaft_position[1]) value = kEncoder * normal(engine);
  for (double& value : record.acceleration[kTip]) value = kAccelerometer * normal(engine);
  const Record judged = on_judged_grid(record, kHighest);
  ASSERT_TRUE(judged.noise);
  EXPECT_NEAR(judged.noise->encoder[1], kEncoder * kEncoder / 5.0, 0.1 * kEncoder * kEncoder / 5.0);
  EXPECT_NEAR(judged.noise->accelerometer[kTip], kAccelerometer * kAccelerometer / 5.0, 0.1 * kAccelerometer * kAccelerometer / 5.0);

  Eigen::FFT<double> transform;
  std::vector<std::complex<double>> spectrum;
  transform.fwd(spectrum, judged.acceleration[kTip]);
  const auto duration = static_cast<double>(judged.size()) * judged.step;
  const auto bins = static_cast<std::size_t>(kHighest * duration);
  double power = 0.0;
  for (std::size_t k = 1; k <= bins; ++k) power += std::norm(spectrum[k]) / static_cast<double>(bins * judged.size());
  EXPECT_NEAR(power, judged.noise->accelerometer[kTip], 0.15 * judged.noise->accelerometer[kTip]);  // five standard deviations of the mean of 800 exponential ones

  // Readings every 10 ms stay what they are.
  Record slow = record;
  slow.encoder_period = 1e-2;
  EXPECT_NEAR(on_judged_grid(slow, kHighest).noise->encoder[1], kEncoder * kEncoder, 0.2 * kEncoder * kEncoder);
}

// A logged run at 1 kHz, its controller and its encoders as well: machines follow it on the judged grid as on the recorded one, also one in whose drives
// something acts on every single command. Compared are the slow parts, for what is faster than the band is on one grid alone.
TEST(JudgedGrid, MachinesFollowItAsTheyFollowTheRecording) {
  sim::MachineSettings measured;
  measured.crane = bench().crane;
  measured.effects = {{"torque_lag", {0.03, 0.2}}};
  const Record record = make_record(simulated_log(measured, bench().controller, kThereAndBack, kDuration, 1), "a", bench().admission);
  ASSERT_DOUBLE_EQ(record.encoder_period, 1e-3);
  const Record judged = on_judged_grid(record, kHighest);
  ASSERT_EQ(judged.recorded_per_point, 5U);
  sim::MachineSettings nominal;
  nominal.crane = bench().crane;
  sim::MachineSettings lagging = measured, losing = nominal;
  losing.effects = {{"command_loss", {0.3, 4.0}}};
  losing.seed = 3;
  const std::array<sim::MachineSettings, 3> machines{nominal, lagging, losing};
  for (const sim::MachineSettings& machine : machines) {
    const Shadow fine = shadow(machine, record, bench_gains()), coarse = shadow(machine, judged, bench_gains());
    const auto slow = [](const std::vector<double>& series, std::size_t n, std::size_t half) {
      double sum = 0.0;
      for (std::size_t k = n - half; k <= n + half; ++k) sum += series[k];
      return sum / static_cast<double>(2 * half + 1);
    };
    double square = 0.0, difference = 0.0;
    for (std::size_t n = 40; n + 40 < judged.size(); ++n) {
      const double a = slow(fine.missing_torque[0], 5 * n, 52), b = slow(coarse.missing_torque[0], n, 10);
      square += a * a;
      difference += (a - b) * (a - b);
    }
    const char* what = machine.effects.empty() ? "nominal" : machine.effects.front().name.c_str();
    // The nominal machine misses 1 to 3 Nm by the lag; a twentieth of that in the machine that has it, which is noise.
    EXPECT_LT(std::sqrt(difference / square), &machine == &machines[1] ? 0.5 : 0.05) << what;
  }
}

}  // namespace
}  // namespace slewlab::diagnosis
