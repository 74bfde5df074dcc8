#include <gtest/gtest.h>

#include <stdexcept>

#include "sim/model/boom.h"
#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

MachineParameters homogeneous(double half_width) {
  MachineParameters parameters;
  parameters.crane = flexible_crane();
  parameters.crane.boom.element_count = 16;
  parameters.crane.boom.profile = {{0.0, half_width, 0.9}, {1.0, half_width, 0.9}};
  return parameters;
}

// (2.15) on a homogeneous boom, all modes alike; (2.16).
TEST(CompressionSoftening, LowersTheFrequenciesOfAHomogeneousBoom) {
  MachineParameters parameters = homogeneous(1.47);
  const BoomParameters nominal = parameters.crane.boom;
  change_by("compression_softening", {8.5e6}, parameters);
  const double moment =
      second_moment_of_area(nominal.chord_outer_diameter, nominal.chord_inner_diameter, 1.47);
  const double critical = critical_buckling_force(nominal.youngs_modulus, moment, nominal.length);
  const auto before = clamped_bending_frequencies(nominal);
  const auto after = clamped_bending_frequencies(parameters.crane.boom);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(after[k] / before[k], compression_factor(8.5e6, critical), 1e-9);
  }
  EXPECT_NEAR(rigid_boom_inertia(parameters.crane.boom), rigid_boom_inertia(nominal),
              1e-12 * rigid_boom_inertia(nominal));
}

TEST(CompressionSoftening, RefusesABoomThatBuckles) {
  MachineParameters parameters = homogeneous(0.3);
  EXPECT_THROW(change_by("compression_softening", {9e6}, parameters), std::invalid_argument);
}

}  // namespace
}  // namespace slewlab::sim
