// Box girder, A-frame and knuckle: against closed forms and fine meshes.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>

#include "sim/analysis/eigen.h"
#include "sim/model/boom.h"
#include "sim/model/box_section.h"
#include "sim/model/crane.h"
#include "tests/sim/angles.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::sim {
namespace {

BoomParameters uniform_box(int elements) {
  BoomParameters boom = thesis_crane(elements).boom;
  boom.type = BoomType::box_girder;
  boom.side_plate = 0.012;
  boom.flange_plate = 0.02;
  boom.profile = {{0.0, 0.8, 1.2}, {1.0, 0.8, 1.2}};
  return boom;
}

// The cantilever's lateral bending by (2.14) with the plates' second moment, and its first torsion by the closed form of a rod clamped at
// one end, a quarter of a wave: both closed forms for the uniform box.
TEST(BoomTypes, AUniformBoxIsACantilever) {
  const BoxSection box{1.6, 2.4, 0.012, 0.02};
  const BoomParameters boom = uniform_box(16);
  const std::vector<double> bending = clamped_bending_frequencies(boom);
  for (int mode = 1; mode <= 3; ++mode) {
    const double exact = clamped_frequency(mode, boom.youngs_modulus, lateral_second_moment(box), boom.mass, boom.length);
    EXPECT_NEAR(bending[static_cast<std::size_t>(mode - 1)] / kTwoPi / exact, 1.0, 4e-4) << mode;  // (2.14) has four digits
  }
  const double polar = boom.mass / boom.length * polar_radius_square(box);
  const double torsion = std::sqrt(boom.shear_modulus * torsion_constant(box) / polar) / (4.0 * boom.length);
  EXPECT_NEAR(frequency_of(clamped_boom_modes(boom), ModeKind::kTorsion, 1) / torsion, 1.0, 1e-3);
}

// A box that tapers: the mean second moment of a stretch against a sum of ten thousand slices.
TEST(BoomTypes, ATaperingBoxHasTheMeanOfItsSections) {
  BoomParameters boom = uniform_box(6);
  boom.profile = {{0.0, 0.9, 1.4}, {0.4, 0.8, 1.3}, {1.0, 0.4, 0.5}};
  double sum = 0.0, flexibility = 0.0;
  constexpr int kSlices = 10000;
  for (int i = 0; i < kSlices; ++i) {
    const BoomStation s = station_at(boom, 0.2 + 0.6 * (i + 0.5) / kSlices);
    const BoxSection box{2.0 * s.half_width, 2.0 * s.half_height, boom.side_plate, boom.flange_plate};
    sum += lateral_second_moment(box) / kSlices;
    flexibility += 1.0 / torsion_constant(box) / kSlices;
  }
  EXPECT_NEAR(mean_second_moment(boom, 0.2, 0.8) / sum, 1.0, 1e-7);
  EXPECT_NEAR(mean_torsional_rigidity(boom, 0.2, 0.8) * flexibility / boom.shear_modulus, 1.0, 1e-3);
}

// Two chords have half the second moment of four. Cylinders at the tip turn the clamped rod's torsion into that of a rod on a spring:
// x tan(x) ... of the textbook, x cot(x) = -k L / (G I_t), w = x / L sqrt(G I_t / J).
TEST(BoomTypes, CylindersHoldTheTwist) {
  BoomParameters boom = thesis_crane(64).boom;
  for (BoomStation& station : boom.profile) station = {station.position, 1.4, 0.5};
  const double four = mean_second_moment(boom, 0.0, 1.0);
  boom.type = BoomType::a_frame;
  EXPECT_NEAR(mean_second_moment(boom, 0.0, 1.0) / four, 0.5, 1e-15);
  boom.cylinders = {.stiffness = 3e7, .position = 1.0, .spacing = 4.0, .base_radius = 3.6, .base_height = -10.0, .force = 0.0};
  const double rigidity = boom.shear_modulus * boom.torsion_constant;
  // The angle at the tip between the boom and the line to the lower end, by the triangle's sides.
  const double level = boom.length * std::cos(boom.angle), up = boom.length * std::sin(boom.angle) + 10.0;
  const double between = std::atan2(up, level) - boom.angle;
  const double spring = 2.0 * 3e7 * std::sin(between) * std::sin(between) * 2.0 * 2.0;
  EXPECT_NEAR(cylinder_hold(boom, boom.angle).torsion / spring, 1.0, 1e-12);
  double low = 0.5 * std::numbers::pi, high = std::numbers::pi;
  for (int i = 0; i < 60; ++i) {
    const double x = 0.5 * (low + high);
    (x / std::tan(x) > -spring * boom.length / rigidity ? low : high) = x;
  }
  const double polar = boom.mass / boom.length * (1.4 * 1.4 + 0.5 * 0.5);
  const double exact = low / boom.length * std::sqrt(rigidity / polar) / kTwoPi;
  EXPECT_NEAR(frequency_of(clamped_boom_modes(boom), ModeKind::kTorsion, 1) / exact, 1.0, 3e-4);
}

// The lever: all weight at the tip, boom level, cylinders upright under half of it carry twice that weight.
TEST(BoomTypes, CylindersCarryTheWeight) {
  BoomParameters boom = thesis_crane().boom;
  boom.type = BoomType::a_frame;
  boom.angle = 0.0;
  boom.mass = 1e-9;
  boom.cylinders = {.stiffness = 1e8, .position = 0.5, .spacing = 2.0, .base_radius = boom.pivot_radius + 0.5 * boom.length, .base_height = -4.0};
  boom.cylinders.force = cylinder_force(boom, 1000.0);
  EXPECT_NEAR(boom.cylinders.force, 2.0 * 1000.0 * kGravity, 1e-6);
  EXPECT_NEAR(cylinder_hold(boom, boom.angle).lateral, -2.0 * 1000.0 * kGravity / 4.0, 1e-6);
}

// At another angle they hold what a boom that is built at that angle is held by; with an oil column, the stiffness goes with its inverse.
TEST(BoomTypes, CylindersHoldOtherwiseAtAnotherAngle) {
  BoomParameters boom = thesis_crane().boom;
  boom.type = BoomType::a_frame;
  boom.cylinders = {.stiffness = 1e8, .position = 0.35, .spacing = 3.0, .base_radius = 6.0, .base_height = -4.0};
  boom.cylinders.force = cylinder_force(boom, 3e4);
  for (const double angle : {0.3, 0.9, 1.3}) {
    BoomParameters there = boom;
    there.angle = angle;
    there.cylinders.force = cylinder_force(there, 3e4);
    const CylinderHold hold = cylinder_hold(boom, angle), built = cylinder_hold(there, angle);
    EXPECT_NEAR(hold.torsion / built.torsion, 1.0, 1e-12);
    EXPECT_NEAR(hold.lateral / built.lateral, 1.0, 1e-12);
    // The line from lower end to boom, by its two ends.
    const auto line = [&](double a) {
      const double along = 0.35 * boom.length;
      return std::hypot(boom.pivot_radius + along * std::cos(a) - 6.0, along * std::sin(a) + 4.0);
    };
    BoomParameters on_oil = boom;
    on_oil.cylinders.oil_column = 5.0;
    const double column = 5.0 + line(angle) - line(boom.angle);
    EXPECT_NEAR(oil_column(on_oil, angle), column, 1e-12);
    EXPECT_NEAR(cylinder_hold(on_oil, angle).torsion / hold.torsion, 5.0 / column, 1e-12);
    EXPECT_DOUBLE_EQ(cylinder_hold(on_oil, angle).lateral, hold.lateral);
  }
}

// A knuckle that does not bend is a straight boom, whatever the number of elements before it.
TEST(BoomTypes, AStraightKnuckleIsABoxGirder) {
  CraneParameters straight = thesis_crane();
  straight.boom = uniform_box(10);
  CraneParameters bent = straight;
  bent.boom.type = BoomType::knuckle;
  bent.boom.knuckle_position = 0.4;
  bent.boom.knuckle_angle = bent.boom.angle;
  const FreeHouseModes expected = free_house_modes(straight), modes = free_house_modes(bent);
  for (std::size_t k = 1; k < 8; ++k) {
    EXPECT_NEAR(modes.frequency[k] / expected.frequency[k], 1.0, 1e-9) << k;
    EXPECT_NEAR(modes.tip[k], expected.tip[k], 1e-9 * std::fabs(expected.tip[0])) << k;
    EXPECT_NEAR(modes.middle[k], expected.middle[k], 1e-9 * std::fabs(expected.tip[0])) << k;
    EXPECT_NEAR(modes.uniform_load[k], expected.uniform_load[k], 1e-9 * expected.uniform_load[0]) << k;
  }
  EXPECT_NEAR(driven_inertia(bent) / driven_inertia(straight), 1.0, 1e-12);
}

// A rigid turn of house and bent boom strains nothing, and its inertia is that of the two pieces.
TEST(BoomTypes, ABentBoomTurnsWithoutStrain) {
  BoomParameters boom = uniform_box(9);
  boom.type = BoomType::knuckle;
  boom.knuckle_position = 0.55;
  boom.knuckle_angle = -10.0 * kRadiansPerDegree;
  const BoomMatrices matrices = assemble_boom(boom);
  Eigen::VectorXd rigid(matrices.mass.rows());
  for (int node = 0; node <= boom.element_count; ++node) {
    const BoomPoint point = point_of_node(boom, node);
    rigid.segment<3>(3 * node) << point.radius, std::cos(point.angle), std::sin(point.angle);
  }
  EXPECT_LT((matrices.stiffness * rigid).cwiseAbs().maxCoeff() / matrices.stiffness.cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_NEAR(rigid.dot(matrices.mass * rigid) / rigid_boom_inertia(boom), 1.0, 1e-12);
}

// A right angle: torsion of the upright part is bending of what it carries. Static, a force F at the end of the level part of length b on an
// upright part of length a (textbook): F b^3 / (3 E I) + F a^3 / (3 E I) + F b^2 a / (G I_t).
TEST(BoomTypes, ARightAngleTwistsItsUprightPart) {
  BoomParameters boom = uniform_box(10);
  boom.type = BoomType::knuckle;
  boom.angle = 90.0 * kRadiansPerDegree;
  boom.knuckle_position = 0.6;
  boom.knuckle_angle = 0.0;
  const BoomMatrices matrices = assemble_boom(boom);
  const Eigen::Index free = matrices.stiffness.rows() - 3;
  Eigen::VectorXd force = Eigen::VectorXd::Zero(free);
  force(free - 3) = 1.0;
  const Eigen::VectorXd bent = matrices.stiffness.bottomRightCorner(free, free).ldlt().solve(force);
  const double a = 0.6 * boom.length, b = 0.4 * boom.length;
  const BoxSection box{1.6, 2.4, 0.012, 0.02};
  const double rigidity = boom.youngs_modulus * lateral_second_moment(box), twisting = boom.shear_modulus * torsion_constant(box);
  EXPECT_NEAR(bent(free - 3) / (b * b * b / (3.0 * rigidity) + a * a * a / (3.0 * rigidity) + b * b * a / twisting), 1.0, 1e-9);
}

}  // namespace
}  // namespace slewlab::sim
