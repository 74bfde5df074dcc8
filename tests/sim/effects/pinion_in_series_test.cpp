#include <gtest/gtest.h>

#include <complex>

#include "sim/integrate/machine.h"
#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// Two springs in series: T (1/k + 1/k_pinion), the pinion's on the slew axis by its ratio squared.
TEST(PinionInSeries, AddsItsOwnDeflection) {
  const CraneParameters crane = fixed_house();
  const auto samples = run(crane, "pinion_in_series", {5e7, 0.0}, 6.0, constant_drive(100.0, 100.0));
  const double torque = 100.0 * torque_factor(crane);
  const double pinion = 5e7 * 3 * 12.7 * 12.7;
  const double wound = torque / group_gear_stiffness(crane) + torque / pinion;
  EXPECT_NEAR(samples.back().deflection[0], group_half_play(crane) + wound, 1e-9 * wound);
}

// (2.7) with Table 2.2, 713 MNm/rad, against 6.9 of the gearbox: 1 %, as thesis 2.6.2 concludes.
TEST(PinionInSeries, OfTheThesisIsNearlyRigid) {
  const CraneParameters crane = fixed_house();
  const auto samples = run(crane, "pinion_in_series", {7.13e8, 0.0}, 6.0, constant_drive(100.0, 100.0));
  const double wound = 100.0 * torque_factor(crane) / group_gear_stiffness(crane);
  EXPECT_NEAR(samples.back().deflection[0] - group_half_play(crane), wound * (1.0 + 6.9 / 713.0),
              1e-6 * wound);
}

// Far below the springs' own frequencies, c of 1 / (1 / (k_g + i w c_g) + 1 / (k_p + i w c_p)) with c_p / k_p = d c_g / k_g.
TEST(PinionInSeries, DampsAsTwoDampedSpringsInSeries) {
  const CraneParameters crane = fixed_house();
  const GearContact before = machine_parameters({.crane = crane, .effects = {}}).gear[0];
  constexpr double kStiffness = 2e7;  // three times the gearbox: both give, both damp
  const double pinion = kStiffness * 3 * 12.7 * 12.7;
  const double frequency = 1e-4 * before.stiffness / before.damping;  // [rad/s]
  for (const double share : {0.0, 0.5, 1.0, 2.0}) {
    const GearContact after = machine_parameters({.crane = crane, .effects = {{"pinion_in_series", {kStiffness, share}}}}).gear[1];
    const std::complex<double> gearbox(before.stiffness, frequency * before.damping);
    const std::complex<double> teeth(pinion, frequency * share * before.damping / before.stiffness * pinion);
    const std::complex<double> both = 1.0 / (1.0 / gearbox + 1.0 / teeth);
    EXPECT_NEAR(after.stiffness, both.real(), 1e-6 * both.real()) << share;
    EXPECT_NEAR(after.damping, both.imag() / frequency, 1e-6 * before.damping) << share;
    if (share == 1.0) {
      EXPECT_NEAR(after.damping / after.stiffness, before.damping / before.stiffness,
                  1e-12 * before.damping / before.stiffness);
    }
  }
}

}  // namespace
}  // namespace slewlab::sim
