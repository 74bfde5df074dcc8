#include "sim/model/crane.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "sim/model/boom.h"
#include "sim/model/drive_line.h"
#include "sim/model/house.h"
#include "tests/sim/angles.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::sim {
namespace {

// All of the crane turned by one radian as one body; the rope follows the tip.
Eigen::VectorXd rigid_turn(const CraneParameters& crane, const CraneMatrices& matrices) {
  Eigen::VectorXd turn = Eigen::VectorXd::Zero(matrices.at.size);
  turn.head(matrices.at.group_count + 1).setOnes();
  const BoomParameters& boom = crane.boom;
  for (int node = 1; node <= boom.element_count; ++node) {
    const double x = boom.length * node / boom.element_count;
    turn.segment<3>(matrices.at.house + 3 * node - 2) << boom.pivot_radius + x * std::cos(boom.angle),
        std::cos(boom.angle), std::sin(boom.angle);
  }
  return turn;
}

TEST(Crane, MatricesAreSymmetricAndTurnFreely) {
  const CraneParameters crane = thesis_crane();
  const CraneMatrices matrices = assemble_crane(crane, GearState::kClosed);
  EXPECT_EQ(matrices.at.size, 2 + 1 + 18 + 2);
  for (const auto* matrix : {&matrices.mass, &matrices.stiffness, &matrices.damping}) {
    EXPECT_LT((*matrix - matrix->transpose()).cwiseAbs().maxCoeff(), 1e-9 * matrix->cwiseAbs().maxCoeff());
  }
  const Eigen::VectorXd turn = rigid_turn(crane, matrices);
  EXPECT_LT((matrices.stiffness * turn).cwiseAbs().maxCoeff(), 1e-9 * matrices.stiffness.cwiseAbs().maxCoeff());
  EXPECT_LT((matrices.damping * turn).cwiseAbs().maxCoeff(), 1e-9 * matrices.damping.cwiseAbs().maxCoeff());
  const double inertia = 2.0 * group_inertia(crane.drive) + driven_inertia(crane) +
                         crane.load.mass * tip_radius(crane.boom) * tip_radius(crane.boom);
  EXPECT_NEAR(turn.dot(matrices.mass * turn) / inertia, 1.0, 1e-9);
}

TEST(Crane, OpenGearsLeaveTheMotorsAlone) {
  const CraneMatrices matrices = assemble_crane(thesis_crane(), GearState::kOpen);
  EXPECT_EQ(matrices.stiffness.topRows(2).cwiseAbs().maxCoeff(), 0.0);
  EXPECT_EQ(matrices.damping.topRows(2).cwiseAbs().maxCoeff(), 0.0);
}

// A rigid boom without a load is Figure 2.15: two inertias and one spring.
TEST(Crane, RigidBoomWithoutLoadIsTwoMasses) {
  CraneParameters crane = thesis_crane(0);
  crane.load.mass = 0.0;
  crane.drive.group_count = 1;
  crane.drive.motors_per_group = 6;
  const CraneMatrices matrices = assemble_crane(crane, GearState::kClosed);
  ASSERT_EQ(matrices.at.size, 2);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrices.stiffness, matrices.mass);
  const double equivalent = series_inertia(group_inertia(crane.drive), driven_inertia(crane));
  EXPECT_NEAR(std::sqrt(solver.eigenvalues()(1)) / kTwoPi,
              natural_frequency(group_stiffness(crane.drive), equivalent), 1e-9);
}

// No boom at all: the house alone behind the gears, as in Table 3.2.
TEST(Crane, HouseAloneIsAMachine) {
  CraneParameters crane;
  crane.drive = thesis_crane().drive;
  crane.house = {.inertia = 5e5, .sensor_radius = 1.0};
  crane.boom.element_count = 0;
  const CraneMatrices matrices = assemble_crane(crane, GearState::kClosed);
  EXPECT_EQ(matrices.at.size, 3);
  EXPECT_DOUBLE_EQ(matrices.mass(2, 2), 5e5);
  const FreeHouseModes modes = free_house_modes(crane);
  ASSERT_EQ(modes.frequency.size(), 1u);
  EXPECT_NEAR(modes.house[0], 1.0 / std::sqrt(5e5), 1e-15);
}

TEST(Crane, ModesOfTheFreeHouseRebuildTheMatrices) {
  // Judge: static flexibility of the house and boom with the rigid motion taken out, and the response of the
  // house to a torque: sum of house^2 over the modes is the inverse of the mass matrix at that place.
  CraneParameters crane = thesis_crane();
  crane.load.mass = 0.0;
  const CraneMatrices open = assemble_crane(crane, GearState::kOpen);
  const Eigen::MatrixXd inverse = open.mass.bottomRightCorner(19, 19).inverse();
  const FreeHouseModes modes = free_house_modes(crane);
  double house = 0.0, tip = 0.0, cross = 0.0;
  for (std::size_t k = 0; k < modes.house.size(); ++k) {
    house += modes.house[k] * modes.house[k];
    tip += modes.tip[k] * modes.tip[k];
    cross += modes.house[k] * modes.tip[k];
  }
  EXPECT_NEAR(house / inverse(0, 0), 1.0, 1e-9);
  EXPECT_NEAR(tip / inverse(16, 16), 1.0, 1e-9);
  EXPECT_NEAR(cross / inverse(0, 16), 1.0, 1e-6);
  EXPECT_NEAR(modes.frequency[0], 0.0, 1e-12);
}

// Judge: the modes of the same crane without a limit, to the bit.
TEST(Crane, ModesAboveTheHighestFrequencyAreLeftOut) {
  CraneParameters crane = thesis_crane(12);
  const FreeHouseModes all = free_house_modes(crane);
  crane.boom.highest_frequency = 200.0;
  const FreeHouseModes kept = free_house_modes(crane);
  const auto count = kept.frequency.size();
  ASSERT_LT(count, all.frequency.size());
  EXPECT_LE(kept.frequency.back(), 2.0 * std::numbers::pi * 200.0);
  EXPECT_GT(all.frequency[count], 2.0 * std::numbers::pi * 200.0);
  for (std::size_t k = 0; k < count; ++k) {
    EXPECT_EQ(kept.frequency[k], all.frequency[k]);
    EXPECT_EQ(kept.tip[k], all.tip[k]);
    EXPECT_EQ(kept.uniform_load[k], all.uniform_load[k]);
    EXPECT_EQ(kept.shear(0, static_cast<Eigen::Index>(k)), all.shear(0, static_cast<Eigen::Index>(k)));
  }
  crane.boom.highest_frequency = 1e-3;
  EXPECT_EQ(free_house_modes(crane).frequency.size(), 1u);  // it still turns
}

TEST(Crane, UniformLoadOnTheRigidModeIsTheBoomsStaticMoment) {
  const CraneParameters crane = thesis_crane();
  const FreeHouseModes modes = free_house_modes(crane);
  const BoomParameters& boom = crane.boom;
  const double moment = boom.length * (boom.pivot_radius + 0.5 * boom.length * std::cos(boom.angle));
  EXPECT_NEAR(modes.uniform_load[0] / modes.house[0] / moment, 1.0, 1e-12);
  EXPECT_NEAR(modes.middle[0] / modes.house[0],
              boom.pivot_radius + 0.5 * boom.length * std::cos(boom.angle), 1e-9);
}

// A slow force at the tip of the free machine. Judge: d'Alembert on the rigid boom; the shear force at x is
// the tip force less the mass beyond x times its acceleration (negative here: what the inner part pulls).
TEST(Crane, ShearOfASlowTipForceIsThatOfTheRigidBoom) {
  CraneParameters crane = thesis_crane(16);
  crane.load.mass = 0.0;
  const BoomParameters& boom = crane.boom;
  const FreeHouseModes modes = free_house_modes(crane);
  const double force = 1000.0;
  const double angular = modes.house[0] * modes.tip[0] * force;
  const double line_mass = boom.mass / boom.length;
  for (int e = 0; e < 16; ++e) {
    double shear = 0.0;
    for (std::size_t k = 1; k < modes.frequency.size(); ++k) {
      shear += modes.shear(e, static_cast<Eigen::Index>(k)) * modes.tip[k] * force /
               (modes.frequency[k] * modes.frequency[k]);
    }
    const double x = boom.length * (e + 0.5) / 16.0;
    const double beyond = boom.pivot_radius * (boom.length - x) +
                          0.5 * std::cos(boom.angle) * (boom.length * boom.length - x * x);
    EXPECT_NEAR(shear, -(force - line_mass * angular * beyond), 0.01 * force) << "element " << e;
  }
}

}  // namespace
}  // namespace slewlab::sim
