#include <gtest/gtest.h>

#include <cmath>

#include "sim/model/boom.h"
#include "sim/model/crane.h"
#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

constexpr double kHouseStiffness = 1e10, kShare = 0.2;

// Ring against house and rigid boom: w^2 = k (1 / J_ring + 1 / J_rest).
TEST(HouseCompliance, RingSwingsAgainstHouseAndBoom) {
  MachineParameters parameters;
  parameters.crane = rigid_crane();
  change_by("house_compliance", {kHouseStiffness, kShare}, parameters);
  const FreeHouseModes modes = free_house_modes(parameters.crane);
  const double ring = kShare * parameters.crane.house.inertia;
  const double rest = house_and_boom_inertia(parameters.crane) - ring;
  ASSERT_EQ(modes.frequency.size(), 2u);
  EXPECT_NEAR(modes.frequency[1], std::sqrt(kHouseStiffness * (1.0 / ring + 1.0 / rest)),
              1e-9 * modes.frequency[1]);
  EXPECT_NEAR(modes.house[1] * ring, -modes.pivot[1] * rest, 1e-6 * std::fabs(modes.house[1]) * ring);
  EXPECT_NEAR(modes.house[0], 1.0 / std::sqrt(ring + rest), 1e-12);
}

// Under a steady acceleration the ring leads what it drives by J_rest a / k_h.
TEST(HouseCompliance, TwistsByTheTorqueItCarries) {
  CraneParameters crane = rigid_crane();
  crane.drive.gear_damping_ratio = 0.5;
  const auto samples = run(crane, "house_compliance", {kHouseStiffness, kShare}, 6.0, constant_drive(100.0, 100.0));
  const double acceleration = 2.0 * 100.0 * torque_factor(crane) / whole_inertia(crane);
  const double rest = house_and_boom_inertia(crane) - kShare * crane.house.inertia;
  const double twist = samples.back().house_angle - samples.back().tip_displacement / tip_radius(crane.boom);
  EXPECT_NEAR(twist, rest * acceleration / kHouseStiffness, 1e-4 * twist);
}

// A stiff house leaves the boom's modes where they are: the elastic ones move with 1 / k_h.
TEST(HouseCompliance, AStiffHouseIsARigidOne) {
  MachineParameters parameters;
  parameters.crane = flexible_crane();
  const FreeHouseModes rigid = free_house_modes(parameters.crane);
  double before = 0.0;
  for (const double stiffness : {1e10, 1e11, 1e12}) {
    change_by("house_compliance", {stiffness, kShare}, parameters);
    const double shift = 1.0 - free_house_modes(parameters.crane).frequency[1] / rigid.frequency[1];
    EXPECT_GT(shift, 0.0);
    if (before > 0.0) {
      EXPECT_NEAR(shift, 0.1 * before, 0.02 * before);
    }
    before = shift;
  }
}

// Modes and full matrices are the same crane.
TEST(HouseCompliance, FullMatricesHaveTheSameRing) {
  MachineParameters parameters;
  parameters.crane = flexible_crane();
  parameters.crane.load = {};
  change_by("house_compliance", {kHouseStiffness, kShare}, parameters);
  const CraneMatrices crane = assemble_crane(parameters.crane, GearState::kOpen);
  const FreeHouseModes modes = free_house_modes(parameters.crane);
  const int from = crane.at.house, count = crane.at.size - from;
  EXPECT_EQ(count, static_cast<int>(modes.frequency.size()));
  EXPECT_NEAR(crane.mass(from, from), kShare * parameters.crane.house.inertia, 1e-6);
  EXPECT_NEAR(crane.stiffness(from, from), kHouseStiffness, 1e-3);
  EXPECT_NEAR(crane.stiffness(from, from + 1), -kHouseStiffness, 1e-3);
}

}  // namespace
}  // namespace slewlab::sim
