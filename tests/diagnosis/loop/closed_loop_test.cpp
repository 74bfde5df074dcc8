// The findings of thesis 4.3 to 4.5 read off time series, and the closed loop's own promises.
#include "diagnosis/loop/closed_loop.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <span>
#include <stdexcept>

#include "controller/controller_file.h"
#include "sim/analysis/spectrum.h"
#include "sim/model/boom.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::diagnosis {
namespace {

constexpr double kStop = 30.0;                   // [s] thesis 4.4
constexpr std::int64_t kSecond = 1'000'000'000;  // [ns]

// The manoeuvre of thesis Figure 4.4 with one of the controllers of config/.
LoopSettings thesis_run(const std::string& controller) {
  LoopSettings run;
  run.machine.crane = sim::thesis_crane();
  run.controller = controller::load_controller_file(std::filesystem::path(SLEWLAB_SOURCE_DIR) / "config" /
                                                    "controllers" / (controller + ".yaml"))
                       .settings;
  run.duration = 45.0;
  run.operator_moves = {{.time = kSecond * 5, .speed_request = 1.0}, {.time = static_cast<std::int64_t>(kStop) * kSecond, .emergency_stop = true}};
  return run;
}

std::span<const double> between(const ClosedLoopSeries& series, const std::vector<double>& values, double from,
                                double to) {
  const std::size_t first = index_at(series, from);
  return std::span<const double>(values).subspan(first, index_at(series, to) - first);
}

double peak_frequency(const ClosedLoopSeries& series, const std::vector<double>& values, double from, double to,
                      double lowest, double highest) {
  return sim::largest_peak(sim::amplitude_spectrum(between(series, values, from, to), series.step), lowest, highest)
      .frequency;
}

TEST(ClosedLoop, SameInputsSameBits) {
  LoopSettings run = thesis_run("thesis");
  run.duration = 10.0;
  const ClosedLoopSeries first = run_closed_loop(run), second = run_closed_loop(run);
  EXPECT_EQ(first.tip_acceleration, second.tip_acceleration);
  EXPECT_EQ(first.motor_torque[1], second.motor_torque[1]);
}

TEST(ClosedLoop, RefusesWhatDoesNotFit) {
  LoopSettings run = thesis_run("thesis");
  run.controller.period = 0.0015;
  EXPECT_THROW(run_closed_loop(run), std::invalid_argument);
  run = thesis_run("thesis");
  run.controller.group_count = 3;
  EXPECT_THROW(run_closed_loop(run), std::invalid_argument);
  run = thesis_run("thesis");
  run.controller.total_ratio = 100.0;
  EXPECT_THROW(run_closed_loop(run), std::invalid_argument);
}

TEST(ClosedLoop, EveryPeriodOfThePlcHoldsTheSpeed) {
  for (const double period : {0.001, 0.002, 0.005, 0.010, 0.020}) {
    LoopSettings run = thesis_run("thesis");
    run.controller.period = period;
    run.duration = 25.0;
    const ClosedLoopSeries series = run_closed_loop(run);
    EXPECT_NEAR(series.house_speed.back(), run.controller.ramp.top_speed, 0.02 * run.controller.ramp.top_speed)
        << period;
  }
}

// Torque held between the controller's answers, and only there.
TEST(ClosedLoop, TorqueChangesOncePerPeriod) {
  LoopSettings run = thesis_run("thesis");
  run.duration = 8.0;
  run.controller.period = 0.02;
  const ClosedLoopSeries series = run_closed_loop(run);
  for (std::size_t i = 1; i < series.time.size(); ++i) {
    if (i % 20 == 0) continue;
    ASSERT_EQ(series.motor_torque[0][i], series.motor_torque[0][i - 1]) << series.time[i];
  }
}

// Thesis 4.3, Figure 4.12: the torque changes its sign as the load swings forward at constant speed; Figure
// 4.11: what follows is the boom's first and second bending.
TEST(BacklashFinding, CrossingThePlayRingsTheFirstTwoModes) {
  const ClosedLoopSeries series = run_closed_loop(thesis_run("thesis_without_play_compensation"));
  const std::vector<double> changes = sign_changes(series, 0, 0.0, kStop);
  ASSERT_GE(changes.size(), 1u);
  EXPECT_GT(changes[0], 9.4);  // after the acceleration
  const std::size_t at = index_at(series, changes[0]);
  EXPECT_GT(series.rope_angle[at], 0.0);  // the load leads and pulls the boom along
  const double second = peak_frequency(series, series.tip_acceleration, changes[0], changes[0] + 7.0, 3.0, 45.0);
  EXPECT_NEAR(second, 5.2, 0.05 * 5.2);
  // The first stands below the 1.31 Hz of free motors because the speed loop holds them; the pole of the linear
  // closed loop lies at 1.061 Hz (`slewlab verify`, row F4.11; docs/model.md).
  const double first = peak_frequency(series, series.tip_acceleration, changes[0], changes[0] + 7.0, 0.8, 3.0);
  EXPECT_NEAR(first, 1.06, 0.02);
  // Nothing of the second mode stood in the window before the crossing.
  const double before = sim::band_rms(between(series, series.tip_acceleration, changes[0] - 4.0, changes[0]),
                                      series.step, 4.0, 6.5);
  const double after = sim::band_rms(between(series, series.tip_acceleration, changes[0], changes[0] + 4.0),
                                     series.step, 4.0, 6.5);
  EXPECT_GT(after, 20.0 * before);
}

// Thesis 4.3: without backlash only the first mode, and only where the jerk is large: in braking.
TEST(BacklashFinding, WithoutPlayOnlyBrakingRings) {
  LoopSettings run = thesis_run("thesis_without_play_compensation");
  run.machine.crane.drive.gearbox_play = run.machine.crane.drive.pinion_play = 0.0;
  const ClosedLoopSeries series = run_closed_loop(run);
  const auto peaks = sim::find_peaks(
      sim::amplitude_spectrum(between(series, series.tip_acceleration, 31.5, 45.0), series.step), 0.5, 45.0, 0.05);
  ASSERT_EQ(peaks.size(), 1u);
  EXPECT_LT(peaks[0].frequency, 1.4);
  const double cruising = sim::band_rms(between(series, series.tip_acceleration, 15.0, kStop), series.step, 0.8, 45.0);
  const double braking = sim::band_rms(between(series, series.tip_acceleration, kStop, 45.0), series.step, 0.8, 45.0);
  EXPECT_GT(braking, 20.0 * cruising);
}

// Thesis 4.3, Figure 4.13: the house shows many frequencies at first and 5.2 Hz when they are gone; its vibration,
// as angular acceleration, is larger than the tip's.
TEST(BacklashFinding, TheHouseRingsHarderAndInTheSecondMode) {
  const LoopSettings run = thesis_run("thesis_without_play_compensation");
  const ClosedLoopSeries series = run_closed_loop(run);
  const double crossing = sign_changes(series, 0, 0.0, kStop).at(0);
  const auto share = [&](double from, double to, double lowest, double highest) {
    return sim::band_rms(between(series, series.house_acceleration, from, to), series.step, lowest, highest);
  };
  // At first the bands of torsion, bending 3 and 4 together outweigh bending 2; two seconds on they are gone.
  EXPECT_GT(share(crossing, crossing + 1.0, 9.0, 45.0), share(crossing, crossing + 1.0, 4.0, 6.5));
  EXPECT_LT(share(crossing + 2.0, crossing + 5.0, 9.0, 45.0), 0.5 * share(crossing + 2.0, crossing + 5.0, 4.0, 6.5));
  const auto largest = [](std::span<const double> values) {
    double size = 0.0;
    for (const double value : values) size = std::max(size, std::fabs(value));
    return size;
  };
  const double radius = sim::tip_radius(run.machine.crane.boom);
  EXPECT_GT(largest(between(series, series.house_acceleration, crossing, crossing + 5.0)),
            2.0 * largest(between(series, series.tip_acceleration, crossing, crossing + 5.0)) / radius);
}

// Thesis 4.4, Figures 4.15 and 4.16.
TEST(PlayCompensationFinding, KeepsEveryGearOnItsFlankUntilTheStop) {
  const ClosedLoopSeries with = run_closed_loop(thesis_run("thesis"));
  const ClosedLoopSeries without = run_closed_loop(thesis_run("thesis_without_play_compensation"));
  for (int group = 0; group < 2; ++group) {
    EXPECT_TRUE(sign_changes(with, group, 0.0, kStop).empty());
    EXPECT_EQ(crossings_between(with, group, 0.0, kStop), 0);
    EXPECT_GE(sign_changes(without, group, 0.0, kStop).size(), 1u);
    EXPECT_EQ(crossings_between(without, group, 0.0, kStop),
              static_cast<int>(sign_changes(without, group, 0.0, kStop).size()));
  }
  // The two groups work against each other, on opposite flanks, from the third second on (Figure 3.18).
  const std::size_t at = index_at(with, 4.0);
  EXPECT_GT(with.gear_torque[0][at], 0.0);
  EXPECT_LT(with.gear_torque[1][at], 0.0);
}

// The share that the PI gives and the share that the map adds are those of Table 3.4 at any instant.
TEST(PlayCompensationFinding, TorquesFollowTheMapOfTable34) {
  const LoopSettings run = thesis_run("thesis");
  const ClosedLoopSeries series = run_closed_loop(run);
  const double rated = run.controller.rated_torque;
  for (const double time : {3.0, 7.0, 12.0, 20.0, 29.0}) {
    const std::size_t at = index_at(series, time);
    const auto halves =
        controller::evaluate_play_map(run.controller.play_compensation, series.average_torque[at] / rated);
    // The PI of each group differs a little from their average.
    EXPECT_NEAR(series.motor_torque[0][at] / rated, halves.half_1, 0.01) << time;
    EXPECT_NEAR(series.motor_torque[1][at] / rated, halves.half_2, 0.01) << time;
  }
}

// Thesis 4.5, Figure 4.18.
TEST(RampFinding, ALinearRampRingsTheFirstModeAndTheSCurveDoesNot) {
  const LoopSettings curved_run = thesis_run("thesis"), linear_run = thesis_run("thesis_linear_ramp");
  const ClosedLoopSeries curved = run_closed_loop(curved_run), linear = run_closed_loop(linear_run);
  const auto ring = [](const ClosedLoopSeries& series, double from) {
    return sim::band_rms(between(series, series.tip_acceleration, from, from + 5.0), series.step, 0.8, 2.0);
  };
  const double curved_end = 5.0 + curved_run.controller.ramp.acceleration_time;
  const double linear_end = 5.0 + linear_run.controller.ramp.acceleration_time;
  EXPECT_GT(ring(linear, linear_end), 4.0 * ring(curved, curved_end));
  EXPECT_LT(peak_frequency(linear, linear.tip_acceleration, linear_end, linear_end + 5.0, 0.5, 45.0), 1.4);
}

// Half of the speed takes half of the time (thesis 4.5).
TEST(RampFinding, TheTimeScalesWithTheSpeed) {
  LoopSettings run = thesis_run("thesis");
  run.duration = 12.0;
  run.operator_moves = {{.time = kSecond * 5, .speed_request = 0.5}};
  const ClosedLoopSeries series = run_closed_loop(run);
  const double half = 0.5 * run.controller.ramp.top_speed;
  EXPECT_NEAR(series.ramped_speed[index_at(series, 5.0 + 0.5 * run.controller.ramp.acceleration_time + 0.02)], half,
              1e-9);
  EXPECT_LT(series.ramped_speed[index_at(series, 5.0 + 0.5 * run.controller.ramp.acceleration_time - 0.1)],
            0.9999 * half);
}

// Thesis 4.2: the work grows linearly with the modes.
TEST(Cost, ModesAdvancedGrowLinearlyWithTheElements) {
  const auto work = [](int elements) {
    LoopSettings run = thesis_run("thesis");
    run.machine.crane.boom.element_count = elements;
    run.duration = 1.0;
    return run_closed_loop(run).mode_steps;
  };
  EXPECT_EQ(work(8) - work(4), work(12) - work(8));
}

}  // namespace
}  // namespace slewlab::diagnosis
