// Passing the clearance twice, half a period of the boom apart (thesis 5.1): the second shock swings against the first.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <numbers>
#include <vector>

#include "sim/analysis/eigen.h"
#include "sim/integrate/machine.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::sim {
namespace {

constexpr double kStep = 1e-3;  // [s]
constexpr double kTorque = 60.0;  // [Nm] per motor: turned around, the gears pass their clearance
constexpr double kTurn = 4.0;     // [s] when the first group turns around

// [m/s^2] Amplitude at `frequency` [Hz] of the tip's acceleration over eight of its periods, with Hann's window, after both groups have
// turned their torque around: group 2 by `interval` [s] later than group 1.
double tip_amplitude(const CraneParameters& crane, double interval, double frequency) {
  Machine machine = make_machine({.crane = crane, .effects = {}, .step = kStep});
  const double begin = kTurn + 2.0 / frequency, length = 8.0 / frequency;
  std::vector<double> acceleration;
  while (time_of(machine) < begin + length) {
    const double time = time_of(machine);
    DriveCommand command;
    // Brought up within a second, so that the start does not ring.
    const double up = kTorque * 0.5 * (1.0 - std::cos(std::numbers::pi * std::min(time, 1.0)));
    command.motor_torque = {time < kTurn ? up : -kTorque, time < kTurn + interval ? up : -kTorque};
    step(machine, command);
    if (time >= begin) acceleration.push_back(read(machine).tip_acceleration);
  }
  EXPECT_GT(machine.state.play_crossings[0], 0);
  EXPECT_GT(machine.state.play_crossings[1], 0);
  std::complex<double> sum = 0.0;
  double windows = 0.0;
  for (std::size_t k = 0; k < acceleration.size(); ++k) {
    const double share = static_cast<double>(k) / static_cast<double>(acceleration.size());
    const double window = 0.5 * (1.0 - std::cos(2.0 * std::numbers::pi * share));
    windows += window;
    sum += window * acceleration[k] * std::polar(1.0, -2.0 * std::numbers::pi * frequency * kStep * static_cast<double>(k));
  }
  return 2.0 * std::abs(sum) / windows;
}

// The interval is half the period of the machine's first bending mode, gears closed, from its own matrices. With a whole period between them
// the second shock adds to the first.
TEST(DoublePassage, HalfABoomPeriodApartTheShocksCancel) {
  const CraneParameters crane = thesis_crane();
  const double frequency = frequency_of(crane_modes(crane), ModeKind::kBending, 1);
  EXPECT_NEAR(frequency, 1.31, 0.02);  // thesis Table 4.1
  const double single = tip_amplitude(crane, 0.0, frequency);
  const double half = tip_amplitude(crane, 0.5 / frequency, frequency), whole = tip_amplitude(crane, 1.0 / frequency, frequency);
  std::printf("tip at %.3f Hz: once %.4f m/s^2, twice half a period apart %.4f, a whole period apart %.4f\n", frequency, single, half, whole);
  EXPECT_LT(half, 0.25 * single);
  EXPECT_GT(whole, 0.6 * single);
}

}  // namespace
}  // namespace slewlab::sim
