#include "sim/model/gear.h"
#include "tests/sim/angles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace slewlab::sim {
namespace {

TEST(Gear, MeshFrequenciesOfTable21) {
  EXPECT_NEAR(planetary_mesh_frequency(110, 8, 20.0), 149.15, 0.01);  // (2.2): 110*8/118*20
  EXPECT_NEAR(pinion_mesh_frequency(12, 0.1), 1.2, 1e-12);            // (2.3)
}

TEST(Gear, PinionPlayOfSection261) {
  // 2 % and 4 % of a module of 24 mm over a radius of 180 mm.
  EXPECT_NEAR(pinion_play(0.02, 0.024, 0.18) / kRadiansPerDegree, 0.153, 5e-4);
  EXPECT_NEAR(pinion_play(0.04, 0.024, 0.18) / kRadiansPerDegree, 0.306, 5e-4);
}

TEST(Gear, PinionMeshStiffnessIsContactAndBendingInSeries) {
  const PinionTooth tooth{.poisson_ratio = 0.3,
                          .length = 0.2,
                          .pinion_radius = 0.18,
                          .height = 0.05,
                          .thickness = 0.07,
                          .youngs_modulus = 210e9,
                          .teeth_in_contact = 2.5};
  // (2.4) to (2.6) written out for a force of 1 N on one tooth.
  const double contact = 4.0 * (1.0 - 0.09) / (std::numbers::pi * 210e9 * 0.07);
  const double bending = 4.0 * std::pow(0.05, 3) / (210e9 * 0.2 * std::pow(0.07, 3));
  EXPECT_NEAR(pinion_mesh_stiffness(tooth) / (2.5 * 0.18 * 0.18 / (contact + bending)), 1.0, 1e-12);
  EXPECT_NEAR(pinion_mesh_stiffness(tooth), 713e6, 0.5e6);  // Table 2.2's result
}

TEST(Gear, TorqueAndEquivalentStiffnessAgreeOnAndOffThePlay) {
  const GearContact gear{.stiffness = 3e9, .damping = 0.0, .half_play = 2e-4};
  for (const double deflection : {-1e-3, -2.1e-4, -1e-4, 0.0, 1e-4, 2.1e-4, 1e-3}) {
    const double torque = contact_torque(gear, deflection, 0.0);
    EXPECT_NEAR(torque, backlash_stiffness(gear, deflection) * deflection, 1e-6);  // (3.6)
    const double beyond = std::fabs(deflection) - gear.half_play;
    EXPECT_NEAR(std::fabs(torque), beyond > 0.0 ? 3e9 * beyond : 0.0, 1e-6);  // (3.5)
    EXPECT_GE(torque * deflection, 0.0);
  }
}

TEST(Gear, DampsInContactOnlyAndNeverPulls) {
  const GearContact gear{.stiffness = 3e9, .damping = 1e7, .half_play = 2e-4};
  EXPECT_EQ(contact_torque(gear, 1e-4, 5.0), 0.0);                              // inside the play
  EXPECT_NEAR(contact_torque(gear, 3e-4, 0.01), 3e9 * 1e-4 + 1e5, 1e-6);        // closing
  EXPECT_EQ(contact_torque(gear, 3e-4, -0.1), 0.0);                             // would pull
  EXPECT_EQ(contact_torque(gear, -3e-4, 0.1), 0.0);
  EXPECT_NEAR(contact_torque(gear, -3e-4, -0.01), -(3e9 * 1e-4 + 1e5), 1e-6);   // mirrored
}

TEST(Gear, WithoutPlayIsASpring) {
  const GearContact gear{.stiffness = 3e9, .damping = 0.0, .half_play = 0.0};
  EXPECT_DOUBLE_EQ(contact_torque(gear, 1e-3, 0.0), 3e6);
  EXPECT_DOUBLE_EQ(contact_torque(gear, -1e-3, 0.0), -3e6);
  EXPECT_EQ(contact_torque(gear, 0.0, 0.0), 0.0);
}

}  // namespace
}  // namespace slewlab::sim
