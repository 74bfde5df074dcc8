#include "sim/model/luffing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim/model/boom.h"
#include "sim/model/cannot_be_built.h"
#include "tests/sim/a_frame_crane.h"
#include "tests/sim/angles.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::sim {
namespace {

CraneParameters bent_crane(int elements) {
  CraneParameters crane = thesis_crane(elements);
  crane.boom.type = BoomType::knuckle;
  crane.boom.side_plate = crane.boom.flange_plate = 0.012;
  crane.boom.knuckle_position = 0.6;
  crane.boom.knuckle_angle = 20.0 * kRadiansPerDegree;
  return crane;
}

// Judge: the eigenproblem of the assembled matrices at that angle (free_house_modes), which knows nothing of clamped modes.
void expect_the_modes_of(const CraneParameters& at_start, const CraneParameters& there) {
  const LuffingBoom boom = luffing_boom(at_start);
  const FreeHouseModes exact = free_house_modes(there);
  const LuffedBasis basis = basis_at(boom, there.boom.angle, static_cast<int>(exact.frequency.size()));
  for (std::size_t k = 0; k < exact.frequency.size(); ++k) {
    EXPECT_NEAR(basis.modes.frequency[k], exact.frequency[k], 1e-7 * exact.frequency[1] + 1e-9 * exact.frequency[k]) << k;
    const auto near = [&](double value, double expected, double scale) {
      EXPECT_NEAR(value, expected, 3e-6 * std::fabs(scale)) << "mode " << k;
    };
    near(basis.modes.house[k], exact.house[k], exact.house[0]);
    near(basis.modes.tip[k], exact.tip[k], exact.tip[0]);
    near(basis.modes.middle[k], exact.middle[k], exact.tip[0]);
    near(basis.modes.uniform_load[k], exact.uniform_load[k], exact.uniform_load[0]);
    near(basis.modes.tip_twist[k], exact.tip_twist[k], exact.tip[0]);
    for (Eigen::Index e = 0; e < exact.shear.rows(); ++e) {
      near(basis.modes.shear(e, static_cast<Eigen::Index>(k)), exact.shear(e, static_cast<Eigen::Index>(k)), exact.shear.cwiseAbs().maxCoeff());
    }
  }
  EXPECT_NEAR(basis.inertia / driven_inertia(there), 1.0, 1e-12);
  EXPECT_NEAR(basis.sheave_radius, sheave_radius(there.boom), 1e-12 * there.boom.length);
}

TEST(Luffing, ModesAreThoseOfTheAngle) {
  for (const double angle : {0.0, 20.0, 53.5, 75.0, 90.0}) {
    CraneParameters there = thesis_crane();
    there.boom.angle = angle * kRadiansPerDegree;
    there.boom.jib_mass = 2000.0;
    there.boom.jib_eccentricity = 3.0;
    CraneParameters at_start = there;
    at_start.boom.angle = 40.0 * kRadiansPerDegree;
    expect_the_modes_of(at_start, there);
  }
}

TEST(Luffing, AKnuckleKeepsItsBend) {
  CraneParameters there = bent_crane(8);
  there.boom.angle += 15.0 * kRadiansPerDegree;
  there.boom.knuckle_angle += 15.0 * kRadiansPerDegree;
  expect_the_modes_of(bent_crane(8), there);
}

// On luffing cylinders, whose hold changes with the angle; a crane that is built at the angle has the weight's lever and the oil of that angle.
// The boom's damping stays that of the start, which is within a percent of the other's.
TEST(Luffing, CylindersHoldAsTheAngleHasThem) {
  for (const double jib_mass : {0.0, 2000.0}) {
    CraneParameters at_start = a_frame_crane();
    at_start.boom.jib_mass = jib_mass;
    at_start.boom.jib_eccentricity = 3.0;
    at_start.boom.cylinders.force = cylinder_force(at_start.boom, at_start.load.mass + jib_mass);
    double least = INFINITY, most = 0.0;  // [Nm/rad]
    for (const double angle : {30.0, 53.5, 54.0, 80.0}) {
      const CraneParameters there = built_at(at_start, angle * kRadiansPerDegree);
      expect_the_modes_of(at_start, there);
      EXPECT_NEAR(luffing_boom(at_start).damping / boom_damping_coefficient(there.boom), 1.0, 0.01);
      const double held = cylinder_hold(there.boom, there.boom.angle).torsion;
      least = std::min(least, held);
      most = std::max(most, held);
    }
    EXPECT_GT(most, 2.0 * least);  // it is no small change
  }
}

// Where two modes of the held boom have one frequency, here bending and torsion that a straight boom does not couple, its modes are those of the
// assembled matrices still. The torsion constant that makes them one at this angle is found by thirds.
TEST(Luffing, ModesMayPassEachOther) {
  constexpr double kAngle = 1.1;  // [rad]
  const auto crane_of = [](double torsion_constant) {
    CraneParameters crane = a_frame_crane();
    crane.boom.torsion_constant = torsion_constant;
    return crane;
  };
  const auto gap = [&](double torsion_constant) {
    const LuffingBoom boom = luffing_boom(crane_of(torsion_constant));
    const LuffedBasis basis = basis_at(boom, kAngle, static_cast<int>(boom.square.size()) + 1);
    return std::min({basis.square[1] / basis.square[0], basis.square[2] / basis.square[1], basis.square[3] / basis.square[2]}) - 1.0;
  };
  double nearest = 0.01;  // [m^4]
  for (int n = 1; n <= 180; ++n) {  // to 0.06
    const double constant = 0.01 * std::pow(1.01, n);
    if (gap(constant) < gap(nearest)) nearest = constant;
  }
  double low = nearest / 1.01, high = nearest * 1.01;
  for (int i = 0; i < 60; ++i) {
    const double third = (high - low) / 3.0;
    if (gap(low + third) < gap(high - third)) {
      high -= third;
    } else {
      low += third;
    }
  }
  const CraneParameters crane = crane_of(0.5 * (low + high));
  EXPECT_LT(gap(crane.boom.torsion_constant), 1e-8);
  expect_the_modes_of(crane, built_at(crane, kAngle));
}

TEST(Luffing, CylindersThatPushTheBoomOverDoNotLuffIt) {
  CraneParameters crane = a_frame_crane();
  crane.motions.luffing = {0.02, 0.01};
  crane.motions.lowest_angle = 0.5;
  crane.motions.highest_angle = 1.4;
  EXPECT_NO_THROW(luffing_boom(crane));
  crane.boom.cylinders.force *= 2000.0;
  EXPECT_THROW(luffing_boom(crane), CannotBeBuilt);
}

// A rigid boom is its inertia alone; dI/da against a difference.
TEST(Luffing, ARigidBoomIsItsInertia) {
  for (const CraneParameters& crane : {thesis_crane(0), bent_crane(0)}) {
    const LuffingBoom boom = luffing_boom(crane);
    const LuffedBasis basis = basis_at(boom, crane.boom.angle, 1);
    EXPECT_NEAR(basis.inertia / driven_inertia(crane), 1.0, 1e-12);
    EXPECT_NEAR(basis.modes.uniform_load[0] / free_house_modes(crane).uniform_load[0], 1.0, 1e-12);
    constexpr double kNudge = 1e-5;  // [rad]
    const double higher = basis_at(boom, crane.boom.angle + kNudge, 1).inertia, lower = basis_at(boom, crane.boom.angle - kNudge, 1).inertia;
    EXPECT_NEAR(basis.inertia_slope / ((higher - lower) / (2.0 * kNudge)), 1.0, 1e-7);
  }
}

TEST(Luffing, NeedsAHouseThatDoesNotGive) {
  CraneParameters crane = thesis_crane();
  crane.house.stiffness = 1e10;
  crane.house.ring_share = 0.3;
  EXPECT_THROW(luffing_boom(crane), CannotBeBuilt);
}

}  // namespace
}  // namespace slewlab::sim
