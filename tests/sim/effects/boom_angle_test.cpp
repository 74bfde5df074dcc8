#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/model/boom.h"
#include "tests/sim/a_frame_crane.h"
#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

CraneParameters raised_by(const CraneParameters& crane, double angle) {
  MachineParameters parameters;
  parameters.crane = crane;
  change_by("boom_angle", {1.0 + angle / crane.boom.angle}, parameters);
  return parameters.crane;
}

// A slender boom's inertia about the slew axis falls with the square of the cosine, where its pivot lies on the axis.
TEST(BoomAngle, SetsTheInertiaByItsCosine) {
  constexpr double kRaised = 0.3;  // [rad]
  CraneParameters crane = flexible_crane();
  crane.boom.pivot_radius = 0.0;
  const CraneParameters raised = raised_by(crane, kRaised);
  const double cosines = std::cos(crane.boom.angle + kRaised) / std::cos(crane.boom.angle);
  EXPECT_NEAR(boom_inertia(raised.boom, 0.0) / boom_inertia(crane.boom, 0.0), cosines * cosines, 1e-12);
  EXPECT_NEAR(tip_radius(raised.boom) / tip_radius(crane.boom), cosines, 1e-12);
  EXPECT_DOUBLE_EQ(raised.load.rope_length, crane.load.rope_length);
}

// As a crane that is built there has it.
TEST(BoomAngle, CylindersHoldAsOfACraneBuiltThere) {
  constexpr double kRaised = -0.2;  // [rad]
  const CraneParameters crane = a_frame_crane();
  const BoomParameters raised = raised_by(crane, kRaised).boom, built = built_at(crane, crane.boom.angle + kRaised).boom;
  const CylinderHold has = cylinder_hold(raised, raised.angle), wanted = cylinder_hold(built, built.angle);
  EXPECT_NEAR(has.torsion / wanted.torsion, 1.0, 1e-12);
  EXPECT_NEAR(has.lateral / wanted.lateral, 1.0, 1e-12);
  EXPECT_NEAR(oil_column(raised, raised.angle), built.cylinders.oil_column, 1e-12);
}

TEST(BoomAngle, AKnuckleKeepsItsBend) {
  CraneParameters crane = flexible_crane();
  crane.boom.knuckle_position = 0.5;
  crane.boom.knuckle_angle = -0.4;
  const BoomParameters raised = raised_by(crane, 0.1).boom;
  EXPECT_NEAR(raised.angle - raised.knuckle_angle, crane.boom.angle + 0.4, 1e-15);
}

TEST(BoomAngle, DoesNotPassTheVertical) {
  CraneParameters crane = flexible_crane();
  crane.boom.angle = 1.4;
  EXPECT_LT(raised_by(crane, 0.3).boom.angle, 0.5 * std::numbers::pi);
  crane.boom.angle = 1.55;
  EXPECT_DOUBLE_EQ(raised_by(crane, 0.3).boom.angle, 1.55);
}

}  // namespace
}  // namespace slewlab::sim
