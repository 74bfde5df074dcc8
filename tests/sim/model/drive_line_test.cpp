#include "sim/model/drive_line.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

#include "sim/model/house.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::sim {
namespace {

TEST(DriveLine, InertiaAndStiffnessOnTheSlewAxis) {
  DriveParameters drive = thesis_crane().drive;
  EXPECT_NEAR(drive_inertia(drive), 1.17, 0.005);  // Table 2.6
  drive.motors_per_group = 1;                      // section 2.10 speaks of one motor of six
  EXPECT_NEAR(group_inertia(drive), 8.76e6, 0.04e6);
  EXPECT_NEAR(group_stiffness(drive), 1.11e9, 0.005e9);
  drive.motors_per_group = 3;
  EXPECT_NEAR(group_inertia(drive), 3.0 * 8.73e6, 0.01e6 * 3.0);
}

// Section 2.10: one motor against the boom at 50 degrees, (2.18), (2.19): 6.96e6 kgm2 and 2.0 Hz.
TEST(DriveLine, GearboxFrequencyOfSection210) {
  DriveParameters drive = thesis_crane().drive;
  drive.motors_per_group = 1;
  const double equivalent = series_inertia(8.76e6, 3.39e7);
  EXPECT_NEAR(equivalent, 6.96e6, 0.01e6);
  EXPECT_NEAR(natural_frequency(group_stiffness(drive), equivalent), 2.0, 0.02);
}

TEST(DriveLine, PlayIsReferredFromThePinionShaft) {
  DriveParameters drive = thesis_crane().drive;
  drive.gearbox_play = 0.002;
  drive.pinion_play = 0.004;
  EXPECT_DOUBLE_EQ(half_play(drive), 0.003 / drive.pinion_ratio);
  drive.gearbox_ratio *= 3.0;  // both plays stand behind the gearbox
  EXPECT_DOUBLE_EQ(half_play(drive), 0.003 / drive.pinion_ratio);
}

TEST(DriveLine, ContactDampingIsAShareOfTheCriticalOne) {
  const DriveParameters drive = thesis_crane().drive;
  const double driven = 3.0e7;
  const GearContact gear = gear_contact(drive, driven);
  const double inertia = series_inertia(drive.group_count * group_inertia(drive), driven);
  const double natural = std::sqrt(drive.group_count * gear.stiffness / inertia);
  EXPECT_NEAR(drive.group_count * gear.damping / (2.0 * inertia * natural), 0.03, 1e-12);
}

// Table 3.2: six motors and the house on the fast axis.
TEST(DriveLine, EigenfrequencyAndAmplitudesOfSection341) {
  const Eigen::MatrixXd mass = drive_mass_matrix(6, 1.17, 1.0);
  const Eigen::MatrixXd stiffness = drive_stiffness_matrix(6, 149.0);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(stiffness, mass);
  const double closed_form = std::sqrt(6.0 * 149.0 / series_inertia(6.0 * 1.17, 1.0));  // (3.20), (3.21)
  EXPECT_NEAR(std::sqrt(solver.eigenvalues()(6)), closed_form, 1e-9);
  EXPECT_NEAR(closed_form / (2.0 * std::numbers::pi), 5.1, 0.05);
  const Eigen::VectorXd shape = solver.eigenvectors().col(6);
  EXPECT_NEAR(-shape(6) / shape(0), 6.0 * 1.17, 1e-9);  // (3.22): 7.0
}

// E8: (3.1) and (3.2) name the same spring twice. What the motors lose the house gains: rows and columns of
// (3.4) sum to zero, and the matrix is symmetric, for any number of motors.
TEST(DriveLine, Erratum8OneSpringBetweenMotorAndHouse) {
  for (const int motors : {1, 2, 6}) {
    const Eigen::MatrixXd stiffness = drive_stiffness_matrix(motors, 149.0);
    EXPECT_EQ(stiffness, stiffness.transpose());
    EXPECT_EQ(stiffness.rowwise().sum().cwiseAbs().maxCoeff(), 0.0);
    EXPECT_EQ(stiffness(motors, motors), 149.0 * motors);
  }
}

}  // namespace
}  // namespace slewlab::sim
