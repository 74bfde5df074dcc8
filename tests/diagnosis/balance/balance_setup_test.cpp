// What the records of a diagnosis share, against the moves that they hold.
#include "diagnosis/balance/balance_setup.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/diagnosis/balance/prepared_axis.h"

namespace slewlab::diagnosis {
namespace {

// Torque switched between levels, as open-loop tests are made.
double switched(double time) {
  constexpr double kLevels[] = {8.0, -8.0, 5.0, -5.0, 9.0, -6.0, 4.0, -7.0};
  return kLevels[static_cast<int>(time / 1.3) % 8];
}

// A small quick axis: its moves last milliseconds, and no window may be longer than they are.
TEST(BalanceSetup, AWindowIsNoLongerThanAMove) {
  for (const double faster : {1.0, 30.0}) {
    SimulatedAxis axis{.resistance = [](double, double, double speed) { return 1.5 * std::tanh(speed / 1e-3) + 0.8 * speed; }, .noise = 2e-3};
    axis.step = 0.01 / faster;
    axis.duration = 20.0 / faster;
    axis.effort = [faster](double time) { return switched(time * faster); };
    const Balance balance = balance_of({record_of(axis)}, axis.inertia, 3.0, true);
    EXPECT_LT(2.0 * static_cast<double>(balance.half_window) * axis.step, 1.3 / faster) << faster << ": 1.3 s between two changes of the torque";
    EXPECT_GE(balance.half_window, kFewestHalf);
  }
}

// Three standard deviations of the speed's noise, or 0.2 % of top speed.
TEST(BalanceSetup, FrictionIsJudgedFromTheSpeedThatThePositionsResolve) {
  SimulatedAxis axis;
  EXPECT_DOUBLE_EQ(balance_of(two_records(axis), axis.inertia, 8.0, true).resolved_speed, 2e-3 * 8.0);
  axis.noise = 3e-3;
  const std::vector<AxisRecord> records = two_records(axis);
  const Balance noisy = balance_of(records, axis.inertia, 8.0, true);
  double largest = 0.0;
  for (const BalanceRecord& record : smoothed(records, noisy)) largest = std::max(largest, record.speed_noise);
  EXPECT_DOUBLE_EQ(noisy.resolved_speed, 3.0 * largest);
}

// A lag of less than one and a half samples may be the recorder's skew.
TEST(BalanceSetup, LagsAreLongerThanARecordersSkew) {
  const SimulatedAxis axis;
  const Balance balance = balance_of(two_records(axis), axis.inertia, 8.0, true);
  ASSERT_FALSE(balance.lateness.empty());
  for (const Lateness& one : balance.lateness) EXPECT_GT(one.time, 1.5 * axis.step);
  for (const BalanceRecord& record : smoothed(two_records(axis), balance)) EXPECT_EQ(record.motion.late_count, balance.lateness.size());
}

TEST(BalanceSetup, ARecordShorterThanItsWindowsIsRefused) {
  const AxisRecord record{"short", 0.01, std::vector<double>(10, 0.0), std::vector<double>(10, 1.0)};
  EXPECT_THROW(balance_of({record}, 1.0, 1.0, true), std::invalid_argument);
}

}  // namespace
}  // namespace slewlab::diagnosis
