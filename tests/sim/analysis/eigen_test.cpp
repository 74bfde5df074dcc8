#include "sim/analysis/eigen.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/model/boom.h"
#include "sim/model/drive_line.h"
#include "sim/model/house.h"
#include "tests/sim/angles.h"
#include "tests/sim/scaled_crane.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::sim {
namespace {

int count_of(const std::vector<Mode>& modes, ModeKind kind) {
  int count = 0;
  for (const Mode& mode : modes) count += mode.kind == kind ? 1 : 0;
  return count;
}

TEST(Eigen, ShapesAreOrthonormalAndSolveTheProblem) {
  const CraneMatrices matrices = assemble_crane(thesis_crane(), GearState::kClosed);
  const EigenSolution solution = solve_eigenproblem(matrices.mass, matrices.stiffness, kGravity / thesis_crane().load.rope_length);
  const Eigen::MatrixXd unit = solution.shape.transpose() * matrices.mass * solution.shape;
  EXPECT_LT((unit - Eigen::MatrixXd::Identity(unit.rows(), unit.cols())).cwiseAbs().maxCoeff(), 1e-6);
  for (Eigen::Index k = 1; k < solution.frequency.size(); ++k) {
    const double w = kTwoPi * solution.frequency(k);
    const Eigen::VectorXd left = matrices.stiffness * solution.shape.col(k);
    const Eigen::VectorXd right = w * w * matrices.mass * solution.shape.col(k);
    EXPECT_LT((left - right).norm(), 1e-5 * right.norm() + 1e-3) << "mode " << k;
  }
}

// The rigid turn must stay at zero and the swing of the load keep its digits beside modes a million times faster.
TEST(Eigen, SlowModesKeepTheirDigitsOnAFineMesh) {
  const std::vector<Mode> coarse = crane_modes(thesis_crane(4));
  const std::vector<Mode> fine = crane_modes(thesis_crane(128));
  EXPECT_EQ(count_of(fine, ModeKind::kRigid), 1);
  EXPECT_LT(fine.front().frequency, 1e-3);
  EXPECT_NEAR(frequency_of(fine, ModeKind::kLoad, 1) / frequency_of(coarse, ModeKind::kLoad, 1), 1.0, 1e-3);
}

// What is rigid and what swings does not depend on how fast it swings: a crane 1e4 times as large swings 100 times as slowly.
TEST(Eigen, AModelAsSlowAsAMountainHasTheSameModes) {
  const std::vector<Mode> modes = crane_modes(thesis_crane());
  for (const double lambda : {1e-4, 1e4}) {
    const std::vector<Mode> scaled = crane_modes(with_lengths_times(thesis_crane(), lambda));
    ASSERT_EQ(scaled.size(), modes.size());
    EXPECT_EQ(count_of(scaled, ModeKind::kRigid), 1);
    for (std::size_t k = 1; k < modes.size(); ++k) {
      EXPECT_EQ(scaled[k].kind, modes[k].kind) << "mode " << k << " at " << lambda;
      EXPECT_NEAR(scaled[k].frequency * std::sqrt(lambda) / modes[k].frequency, 1.0, 1e-6) << "mode " << k << " at " << lambda;
    }
  }
}

TEST(Eigen, DriveLineIsTwoMassesAndFreeDifferences) {
  const std::vector<Mode> modes = drive_line_modes(6, 1.17, 149.0, 1.0);
  EXPECT_EQ(count_of(modes, ModeKind::kRigid), 1);
  // Five ways in which the motors swing against each other with the house at rest, sqrt(k / J).
  for (std::size_t k = 1; k <= 5; ++k) EXPECT_NEAR(modes[k].frequency * kTwoPi, std::sqrt(149.0 / 1.17), 1e-6);
  EXPECT_NEAR(modes[6].frequency, natural_frequency(6.0 * 149.0, series_inertia(6.0 * 1.17, 1.0)), 1e-9);
}

TEST(Eigen, ClampedBoomSeparatesBendingAndTorsion) {
  BoomParameters boom = thesis_crane(24).boom;
  for (BoomStation& station : boom.profile) station = {station.position, 1.47, 0.9};
  const std::vector<Mode> modes = clamped_boom_modes(boom);
  const double moment = second_moment_of_area(boom.chord_outer_diameter, boom.chord_inner_diameter, 1.47);
  for (int mode = 1; mode <= 3; ++mode) {  // (2.14)
    const double exact = clamped_frequency(mode, boom.youngs_modulus, moment, boom.mass, boom.length);
    EXPECT_NEAR(frequency_of(modes, ModeKind::kBending, mode) / exact, 1.0, 1e-3);
  }
  const double polar = boom.mass / boom.length * (1.47 * 1.47 + 0.9 * 0.9);
  const double quarter_wave =
      std::sqrt(boom.shear_modulus * boom.torsion_constant / polar) / (4.0 * boom.length);
  EXPECT_NEAR(frequency_of(modes, ModeKind::kTorsion, 1) / quarter_wave, 1.0, 1e-3);
  EXPECT_NEAR(frequency_of(modes, ModeKind::kTorsion, 2) / (3.0 * quarter_wave), 1.0, 2e-3);
}

TEST(Eigen, KindsOfTheThesisCrane) {
  const std::vector<Mode> modes = crane_modes(thesis_crane());
  EXPECT_EQ(count_of(modes, ModeKind::kRigid), 1);
  EXPECT_EQ(count_of(modes, ModeKind::kLoad), 2);
  EXPECT_EQ(count_of(modes, ModeKind::kDrive), 1);  // group against group
  // Two equal groups against each other: the house stands still, sqrt(k / J) of one group.
  const CraneParameters crane = thesis_crane();
  EXPECT_NEAR(frequency_of(modes, ModeKind::kDrive, 1),
              natural_frequency(group_stiffness(crane.drive), group_inertia(crane.drive)), 1e-6);
  EXPECT_NEAR(1.0 / frequency_of(modes, ModeKind::kLoad, 1), 13.5, 0.1);  // on motors that are free to turn
  for (const Mode& mode : modes) {
    if (mode.kind == ModeKind::kRigid) continue;
    EXPECT_NEAR(mode.energy.gear + mode.energy.load + mode.energy.boom, 1.0, 1e-6) << mode.frequency;
  }
}

TEST(Eigen, DampingOfTheLoadAndOfTheGears) {
  const std::vector<Mode> modes = crane_modes(thesis_crane());
  EXPECT_NEAR(modes[1].damping_ratio, 0.005, 0.001);  // thesis 3.3.3, the crane's own damping beside it
  CraneParameters rigid = thesis_crane(0);
  rigid.load.mass = 0.0;
  rigid.drive.group_count = 1;
  rigid.drive.motors_per_group = 6;
  EXPECT_NEAR(crane_modes(rigid).back().damping_ratio, 0.03, 1e-9);  // thesis 3.3.1
}

TEST(Eigen, OpenGearsLeaveEveryMotorFree) {
  const std::vector<Mode> modes = crane_modes(thesis_crane(), GearState::kOpen);
  EXPECT_EQ(count_of(modes, ModeKind::kRigid), 3);
  EXPECT_EQ(count_of(modes, ModeKind::kDrive), 0);
}

TEST(Eigen, PolesOfADampedOscillator) {
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(1, 1);
  const auto poles = oscillating_poles(2.0 * one, 2.0 * 2.0 * 0.1 * 5.0 * one, 2.0 * 25.0 * one);
  ASSERT_EQ(poles.size(), 1u);
  EXPECT_NEAR(poles[0].real(), -0.5, 1e-9);
  EXPECT_NEAR(poles[0].imag(), 5.0 * std::sqrt(1.0 - 0.01), 1e-9);
  EXPECT_TRUE(oscillating_poles(one, 10.0 * one, one).empty());  // overdamped
}

TEST(Eigen, AMissingModeIsNotANumber) {
  EXPECT_TRUE(std::isnan(frequency_of(crane_modes(thesis_crane(0)), ModeKind::kBending, 1)));
}

}  // namespace
}  // namespace slewlab::sim
