#include <gtest/gtest.h>

#include <complex>

#include "sim/integrate/machine.h"
#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// The exact complex stiffness of two damped springs in series, at a frequency far below c / k.
TEST(HydraulicCompliance, IsTwoDampedSpringsInSeries) {
  const CraneParameters crane = flexible_crane();
  const GearContact gear = machine_parameters({.crane = crane, .effects = {}}).gear[0];
  const GearContact both = machine_parameters({.crane = crane, .effects = {{"hydraulic_compliance", {5e9, 5e7}}}}).gear[0];
  constexpr double kFrequency = 1e-3;  // [rad/s]
  const std::complex<double> first(gear.stiffness, kFrequency * gear.damping);
  const std::complex<double> oil(5e9, kFrequency * 5e7);
  const std::complex<double> series = first * oil / (first + oil);
  EXPECT_NEAR(both.stiffness, series.real(), 1e-9 * series.real());
  EXPECT_NEAR(both.damping, series.imag() / kFrequency, 1e-6 * both.damping);
  EXPECT_EQ(both.half_play, gear.half_play);
}

}  // namespace
}  // namespace slewlab::sim
