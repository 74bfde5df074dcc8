#include "sim/model/load.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "sim/model/boom.h"
#include "tests/sim/angles.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::sim {
namespace {

TEST(Load, SinglePendulumOfSection343) {
  EXPECT_NEAR(1.0 / pendulum_frequency(60.0), 15.5, 0.05);               // (2.17)
  EXPECT_NEAR(swing_angle(1.75, 60.0) / kRadiansPerDegree, 4.1, 0.05);             // (3.29)
  EXPECT_NEAR(1.0 / pendulum_frequency(60.0), kTwoPi * std::sqrt(60.0 / 9.81), 1e-12);
}

TEST(Load, DoublePendulumFrequenciesOfAClosedForm) {
  // Rope L and uniform rod l: det(K - w^2 M) of (3.18), (3.19) with its upper end held, a quadratic in w^2:
  // L l / 12 w^4 - g (L/2 ... ) solved below from the two equations by hand,
  //   L b1'' + l/2 b2'' + g b1 = 0,   L/2 b1'' + l/3 b2'' + g/2 b2 = 0.
  const LoadParameters load = thesis_crane().load;
  const double L = load.rope_length, l = load.rod_length, g = kGravity;
  const double a = L * l / 3.0 - L * l / 4.0;
  const double b = -g * (L / 2.0 + l / 3.0);
  const double c = g * g / 2.0;
  const double slow = std::sqrt((-b - std::sqrt(b * b - 4.0 * a * c)) / (2.0 * a));
  const double fast = std::sqrt((-b + std::sqrt(b * b - 4.0 * a * c)) / (2.0 * a));
  const LoadOnSpring spring = load_on_spring(load);
  EXPECT_NEAR(spring.frequency(0) / slow, 1.0, 1e-9);
  EXPECT_NEAR(spring.frequency(1) / fast, 1.0, 1e-9);
  EXPECT_NEAR(kTwoPi / slow, 15.6, 0.1);  // thesis 3.4.3: 15.7 s in its simulation
}

TEST(Load, BothModesHaveTheirDampingRatio) {
  const LoadOnSpring spring = load_on_spring(thesis_crane().load);
  const Eigen::Matrix2d modal = spring.modes.transpose() * spring.damping * spring.modes;
  for (int j = 0; j < 2; ++j) EXPECT_NEAR(modal(j, j) / (2.0 * 0.005 * spring.frequency(j)), 1.0, 1e-9);
  EXPECT_NEAR(modal(0, 1), 0.0, 1e-9);
}

TEST(Load, PointLoadHasOneMode) {
  LoadParameters load = thesis_crane().load;
  load.rod_length = 0.0;
  const LoadOnSpring spring = load_on_spring(load);
  EXPECT_NEAR(spring.frequency(0) / kTwoPi, pendulum_frequency(60.0), 1e-12);
  EXPECT_EQ(spring.frequency(1), 0.0);
  load.mass = 0.0;
  EXPECT_EQ(load_on_spring(load).rope_stiffness, 0.0);
}

// E1: (3.18) must be symmetric and give the kinetic energy of a uniform rod hung on a rope. Judge: that
// energy integrated along the rod, 1/2 m int (y' + L b1' + s b2')^2 ds / l.
TEST(Load, Erratum1MassMatrixIsTheRodsKineticEnergy) {
  LoadParameters load = thesis_crane().load;
  load.rod_length = 4.0;
  const Eigen::Vector3d rate{0.3, -0.7, 1.9};
  const double start = rate(0) + load.rope_length * rate(1);
  const double end = start + load.rod_length * rate(2);
  const double twice_energy = load.mass * (start * start + start * end + end * end) / 3.0;
  const Eigen::Matrix3d right = load_mass_matrix(load);
  EXPECT_NEAR(rate.dot(right * rate) / twice_energy, 1.0, 1e-12);
  EXPECT_EQ(right, right.transpose());
  const Eigen::Matrix3d printed = load_mass_matrix_as_printed(load);
  EXPECT_NE(printed(0, 2), printed(2, 0));
  EXPECT_NEAR(printed(2, 2) / right(2, 2), 1.75, 1e-12);  // 7/12 for 1/3
}

// E7: (4.1) multiplies the side force by the rope length. Judge: the moment about the slew axis of the side
// force M g sin(beta) at the tip.
TEST(Load, Erratum7MomentArmOfTheLoad) {
  BoomParameters boom = thesis_crane().boom;
  const double arm = tip_radius(boom);
  const double side_force = 30e3 * kGravity * std::sin(5.0 * kRadiansPerDegree);
  EXPECT_NEAR(quasi_static_slewing_moment(5.4e7, 0.0, 30e3, arm, 5.0 * kRadiansPerDegree), side_force * arm, 1e-6);
  const double printed = quasi_static_slewing_moment(5.4e7, 0.0156, 30e3, 60.0, 5.0 * kRadiansPerDegree);
  const double right = quasi_static_slewing_moment(5.4e7, 0.0156, 30e3, arm, 5.0 * kRadiansPerDegree);
  EXPECT_NEAR(printed - right, side_force * (60.0 - arm), 1e-6);
}

}  // namespace
}  // namespace slewlab::sim
