#include "sim/effects/pinion_in_series.h"

#include <gtest/gtest.h>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// Two springs in series: T (1/k + 1/k_pinion), the pinion's on the slew axis by its ratio squared.
TEST(PinionInSeries, AddsItsOwnDeflection) {
  const CraneParameters crane = fixed_house();
  const auto samples = run(crane, "pinion_in_series", {5e7}, 6.0, constant_drive(100.0, 100.0));
  const double torque = 100.0 * torque_factor(crane);
  const double pinion = 5e7 * 3 * 12.7 * 12.7;
  const double wound = torque / group_gear_stiffness(crane) + torque / pinion;
  EXPECT_NEAR(samples.back().deflection[0], group_half_play(crane) + wound, 1e-9 * wound);
}

// (2.7) with Table 2.2, 713 MNm/rad, against 6.9 of the gearbox: 1 %, as thesis 2.6.2 concludes.
TEST(PinionInSeries, OfTheThesisIsNearlyRigid) {
  const CraneParameters crane = fixed_house();
  const auto samples = run(crane, "pinion_in_series", {7.13e8}, 6.0, constant_drive(100.0, 100.0));
  const double wound = 100.0 * torque_factor(crane) / group_gear_stiffness(crane);
  EXPECT_NEAR(samples.back().deflection[0] - group_half_play(crane), wound * (1.0 + 6.9 / 713.0),
              1e-6 * wound);
}

}  // namespace
}  // namespace slewlab::sim
