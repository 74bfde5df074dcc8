#include <gtest/gtest.h>

#include "sim/analysis/eigen.h"
#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// Damping is proportional to stiffness (3.15), so that of each mode of the clamped boom is multiplied: the modes are computed from
// the matrices of the changed crane, and stand where they stood.
TEST(BoomDamping, MultipliesTheDampingOfEveryMode) {
  MachineParameters parameters;
  parameters.crane = flexible_crane();
  change_by("boom_damping", {3.0}, parameters);
  const std::vector<Mode> before = clamped_boom_modes(flexible_crane().boom), after = clamped_boom_modes(parameters.crane.boom);
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_NEAR(after[i].frequency, before[i].frequency, 1e-9 * before[i].frequency);
    EXPECT_GT(before[i].damping_ratio, 0.0);
    EXPECT_NEAR(after[i].damping_ratio, 3.0 * before[i].damping_ratio, 1e-9 * after[i].damping_ratio);
  }
}

}  // namespace
}  // namespace slewlab::sim
