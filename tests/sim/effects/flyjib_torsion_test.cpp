#include "sim/effects/flyjib_torsion.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "sim/model/boom.h"
#include "sim/model/crane.h"
#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// A clamped boom without mass of its own: one mass on the sum of two flexibilities,
// 1 / w^2 = m (L^3 / (3 E I) + e^2 L / (G I_t)).
TEST(FlyjibTorsion, MassOnBendingAndTwistOfALightBoom) {
  MachineParameters parameters;
  parameters.crane = flexible_crane();
  BoomParameters& boom = parameters.crane.boom;
  boom.mass = 1e-3;
  boom.profile = {{0.0, 1.47, 0.9}, {1.0, 1.47, 0.9}};
  flyjib_torsion().change({3000.0, 5.0}, parameters);
  const BoomMatrices matrices = assemble_boom(boom);
  const Eigen::Index free = matrices.mass.rows() - 3;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      matrices.stiffness.bottomRightCorner(free, free), matrices.mass.bottomRightCorner(free, free),
      Eigen::EigenvaluesOnly);
  const double moment = second_moment_of_area(boom.chord_outer_diameter, boom.chord_inner_diameter, 1.47);
  const double flexibility = 1.0 / lateral_stiffness(boom.youngs_modulus, moment, boom.length) +
                             25.0 * boom.length / (boom.shear_modulus * boom.torsion_constant);
  EXPECT_NEAR(solver.eigenvalues()(0) * 3000.0 * flexibility, 1.0, 1e-6);
}

// The rope hangs from the jib: a rigid crane's tip moves with the sheave's radius, and feels the jib's
// inertia.
TEST(FlyjibTorsion, SheaveStandsInFrontOfTheTip) {
  MachineParameters parameters;
  parameters.crane = rigid_crane();
  const double without = rigid_boom_inertia(parameters.crane.boom);
  flyjib_torsion().change({3000.0, 5.0}, parameters);
  const BoomParameters& boom = parameters.crane.boom;
  const double radius = tip_radius(boom) + 5.0 * std::sin(boom.angle);
  const FreeHouseModes modes = free_house_modes(parameters.crane);
  EXPECT_NEAR(modes.tip[0] / modes.house[0], radius, 1e-9);
  EXPECT_NEAR(rigid_boom_inertia(boom) - without, 3000.0 * radius * radius, 1e-3);
}

// The finite elements turn a whole crane about the slew axis with the same inertia.
TEST(FlyjibTorsion, ElementsAndRigidBoomAgree) {
  MachineParameters parameters;
  parameters.crane = flexible_crane();
  flyjib_torsion().change({3000.0, 5.0}, parameters);
  const FreeHouseModes modes = free_house_modes(parameters.crane);
  MachineParameters rigid = parameters;
  rigid.crane.boom.element_count = 0;
  const FreeHouseModes one = free_house_modes(rigid.crane);
  EXPECT_NEAR(modes.house[0] / one.house[0], 1.0, 1e-3);
  EXPECT_NEAR(modes.tip[0] / modes.house[0], one.tip[0] / one.house[0], 1e-9);
}

}  // namespace
}  // namespace slewlab::sim
