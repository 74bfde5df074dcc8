// Expected: the modes of sim/model (their own tests stand on the thesis), and closed forms.
#include "diagnosis/evaluation/structure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "sim/machine/machine_file.h"
#include "sim/model/boom.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::diagnosis::withheld {
namespace {

// Of a straight boom and of one that is bent, where nodes stand at uneven distances and the middle lies between two of them.
TEST(Structure, WithoutAChangeTheModesAreThoseOfTheModel) {
  sim::CraneParameters knuckle = sim::load_machine_file(SLEWLAB_SOURCE_DIR "/config/cranes/knuckle.yaml").parameters;
  knuckle.boom.element_count = 16;
  for (const sim::CraneParameters& crane : {sim::thesis_crane(16), knuckle}) {
    const Structure structure = make_structure(crane, {});
    const sim::FreeHouseModes expected = sim::free_house_modes(crane);
    ASSERT_EQ(structure.modes.frequency.size(), expected.frequency.size());
    for (std::size_t k = 0; k < expected.frequency.size(); ++k) {
      EXPECT_NEAR(structure.modes.frequency[k], expected.frequency[k], 1e-6 * expected.frequency[k] + 1e-9) << k;
      EXPECT_NEAR(structure.modes.house[k], expected.house[k], 1e-9 + 1e-6 * std::fabs(expected.house[k])) << k;
      EXPECT_NEAR(structure.modes.tip[k], expected.tip[k], 1e-9 + 1e-6 * std::fabs(expected.tip[k])) << k;
      EXPECT_NEAR(structure.modes.middle[k], expected.middle[k], 1e-9 + 1e-6 * std::fabs(expected.middle[0])) << k;
      EXPECT_NEAR(structure.modes.tip_twist[k], expected.tip_twist[k], 1e-9 + 1e-6 * std::fabs(expected.tip_twist[k])) << k;
      EXPECT_NEAR(structure.modes.uniform_load[k], expected.uniform_load[k], 1e-6 * std::fabs(expected.uniform_load[0]));
      EXPECT_NEAR(structure.modes.damping_rate[k], expected.damping_rate[k], 1e-6 * expected.damping_rate[k]) << k;
      for (Eigen::Index e = 0; e < expected.shear.rows(); ++e) {
        const double most = expected.shear.col(static_cast<Eigen::Index>(k)).cwiseAbs().maxCoeff();
        EXPECT_NEAR(structure.modes.shear(e, static_cast<Eigen::Index>(k)), expected.shear(e, static_cast<Eigen::Index>(k)), 1e-6 * most) << e << " of mode " << k;
      }
    }
  }
}

// A very stiff ring and pedestal change nothing.
TEST(Structure, StiffRingAndPedestalLeaveTheFirstBendingMode) {
  const sim::CraneParameters crane = sim::thesis_crane(16);
  StructureChange change;
  change.ring_stiffness = 1e14;
  change.pedestal_stiffness = 1e13;
  change.pedestal_mass = 3e5;
  const double expected = sim::free_house_modes(crane).frequency[1];
  EXPECT_NEAR(make_structure(crane, change).modes.frequency[1], expected, 1e-4 * expected);
}

// A boom that nothing moves on a soft pedestal: one oscillator of pedestal, house and boom.
TEST(Structure, PedestalAloneSwingsAsOneMass) {
  sim::CraneParameters crane = sim::thesis_crane(16);
  crane.house.inertia = 1e16;
  StructureChange change;
  change.pedestal_stiffness = 1e6;
  change.pedestal_mass = 3e5;
  change.pedestal_damping_ratio = 0.03;
  const Structure structure = make_structure(crane, change);
  const double expected = std::sqrt(1e6 / (3e5 + crane.boom.mass));
  EXPECT_NEAR(structure.modes.frequency[1], expected, 0.01 * expected);  // the boom bends a little
  EXPECT_NEAR(structure.modes.damping_rate[1], 2.0 * 0.03 * expected, 0.02 * expected);
}

// A homogeneous clamped boom under a force that points at its pivot. Rayleigh's quotient with the first mode of a
// clamped beam (integrals over it by Felgar 1950: phi'^2 4.6479 / L, phi''^2 12.3624 / L^3, tip 2):
//   (f_C / f)^2 = 1 - F (4.6479 - 4) L^2 / (12.3624 E I).
// (2.15) takes about twice that, because a clamped beam does not vibrate in the shape in which it buckles. The
// buckling force is (2.16).
TEST(Structure, CompressionSoftensAHomogeneousClampedBoomAsRayleighsQuotientSays) {
  sim::CraneParameters crane = sim::thesis_crane(16);
  crane.house.inertia = 1e16;
  for (sim::BoomStation& station : crane.boom.profile) station.half_width = 1.47;
  const double rigidity =
      crane.boom.youngs_modulus * sim::second_moment_of_area(crane.boom.chord_outer_diameter,
                                                             crane.boom.chord_inner_diameter, 1.47);
  const double critical = sim::critical_buckling_force(1.0, rigidity, crane.boom.length);
  StructureChange change;
  change.axial_force = 0.1 * critical;
  const double ratio = make_structure(crane, change).modes.frequency[1] / make_structure(crane, {}).modes.frequency[1];
  const double square = 1.0 - change.axial_force * (4.6479 - 4.0) * crane.boom.length * crane.boom.length / (12.3624 * rigidity);
  EXPECT_NEAR(ratio, std::sqrt(square), 0.002);  // the shape gives way a little, and the house's 1e16 is not infinite
  change.axial_force = 1.02 * critical;
  EXPECT_THROW(make_structure(crane, change), std::invalid_argument);
}

// An axial force that points at the pivot does nothing to the rigid rotation: its inertia and its zero frequency stay.
TEST(Structure, CompressionLeavesTheRigidRotation) {
  const sim::CraneParameters crane = sim::thesis_crane(16);
  StructureChange change;
  change.axial_force = 5e6;
  const Structure structure = make_structure(crane, change);
  EXPECT_EQ(structure.modes.frequency[0], 0.0);
  EXPECT_NEAR(1.0 / (structure.modes.house[0] * structure.modes.house[0]), sim::driven_inertia(crane),
              1e-6 * sim::driven_inertia(crane));
}

TEST(Structure, JibAddsItsInertia) {
  const sim::CraneParameters crane = sim::thesis_crane(16);
  StructureChange change;
  change.jib_mass = 2000.0;
  change.jib_eccentricity = 4.0;
  const Structure structure = make_structure(crane, change);
  const double radius = sim::tip_radius(crane.boom) + 4.0 * std::sin(crane.boom.angle);
  const double expected = sim::driven_inertia(crane) + 2000.0 * radius * radius;
  EXPECT_NEAR(1.0 / (structure.modes.house[0] * structure.modes.house[0]), expected, 1e-6 * expected);
}

}  // namespace
}  // namespace slewlab::diagnosis::withheld
