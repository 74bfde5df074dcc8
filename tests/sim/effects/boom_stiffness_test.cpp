#include <gtest/gtest.h>

#include "sim/model/boom.h"
#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// Every frequency with the square root.
TEST(BoomStiffness, ScalesTheFrequenciesByItsRoot) {
  MachineParameters parameters;
  parameters.crane = flexible_crane();
  change_by("boom_stiffness", {0.81}, parameters);
  const auto before = clamped_bending_frequencies(flexible_crane().boom);
  const auto after = clamped_bending_frequencies(parameters.crane.boom);
  for (std::size_t k = 0; k < before.size(); ++k) EXPECT_NEAR(after[k] / before[k], 0.9, 1e-9);
  EXPECT_DOUBLE_EQ(parameters.crane.boom.shear_modulus, 0.81 * 81e9);
}

}  // namespace
}  // namespace slewlab::sim
