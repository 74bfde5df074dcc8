#include "sim/model/luffing.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/model/boom.h"
#include "sim/model/cannot_be_built.h"
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
