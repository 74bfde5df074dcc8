#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/integrate/reference.h"
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
  change_by("flyjib_torsion", {3000.0, 5.0}, parameters);
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
  change_by("flyjib_torsion", {3000.0, 5.0}, parameters);
  const BoomParameters& boom = parameters.crane.boom;
  const double radius = tip_radius(boom) + 5.0 * std::sin(boom.angle);
  const FreeHouseModes modes = free_house_modes(parameters.crane);
  EXPECT_NEAR(modes.tip[0] / modes.house[0], radius, 1e-9);
  EXPECT_NEAR(rigid_boom_inertia(boom) - without, 3000.0 * radius * radius, 1e-3);
}

// The accelerometer stays on the boom's own tip: on a rigid crane it reads tip_radius times the angular acceleration,
// which the house's accelerometer gives as well, and not the sheave's radius, 5 sin(angle) = more.
TEST(FlyjibTorsion, AccelerometerStaysOnTheTip) {
  for (const int elements : {0, 6}) {
    MachineParameters parameters;
    parameters.crane = rigid_crane();
    parameters.crane.boom.element_count = elements;
    change_by("flyjib_torsion", {3000.0, 5.0}, parameters);
    const PlantModel model = make_plant_model(parameters.crane, 0.001);
    // The rigid rotation is the first mode, of boom elements as well.
    EXPECT_NEAR(model.tip_sensor[0] / model.house[0], tip_radius(parameters.crane.boom), 1e-6) << elements;
  }
  const auto samples = run(rigid_crane(), "flyjib_torsion", {3000.0, 5.0}, 1.0, constant_drive(100.0, 100.0));
  const CraneParameters crane = rigid_crane();
  double largest = 0.0;
  for (const BenchSample& sample : samples) {
    const double angular = sample.readings.house_acceleration / crane.house.sensor_radius;
    EXPECT_NEAR(sample.readings.tip_acceleration, tip_radius(crane.boom) * angular, 1e-12) << sample.time;
    largest = std::max(largest, std::fabs(angular));
  }
  EXPECT_GT(largest, 1e-4);  // it did accelerate
}

// A boom that bends and twists under its jib: SUNDIALS reads the same there, and something else without the jib.
TEST(FlyjibTorsion, AccelerometerReadsWhatSundialsSays) {
  constexpr double kStep = 0.001;
  MachineParameters parameters;
  parameters.crane = flexible_crane();
  const std::vector<double> values{3000.0, 5.0};
  change_by("flyjib_torsion", values, parameters);
  const Drive drive = constant_drive(110.0, 95.0);
  const auto with = run(flexible_crane(), "flyjib_torsion", values, 1.0, drive);
  const auto without = run({.crane = flexible_crane(), .effects = {}}, 1.0, drive);
  const ReferencePointer reference = make_reference(reference_machine(parameters.crane), {.tolerance = 1e-8}, {});
  double error = 0.0, effect = 0.0;
  for (std::size_t k = 0; k < with.size(); ++k) {
    advance(*reference, drive(0.0).motor_torque, static_cast<double>(k + 1) * kStep);
    const double truth = read(*reference).tip_acceleration;
    error += std::pow(with[k].readings.tip_acceleration - truth, 2);
    effect += std::pow(without[k].readings.tip_acceleration - truth, 2);
  }
  EXPECT_LT(std::sqrt(error / effect), 0.02);
}

// The finite elements turn a whole crane about the slew axis with the same inertia.
TEST(FlyjibTorsion, ElementsAndRigidBoomAgree) {
  MachineParameters parameters;
  parameters.crane = flexible_crane();
  change_by("flyjib_torsion", {3000.0, 5.0}, parameters);
  const FreeHouseModes modes = free_house_modes(parameters.crane);
  MachineParameters rigid = parameters;
  rigid.crane.boom.element_count = 0;
  const FreeHouseModes one = free_house_modes(rigid.crane);
  EXPECT_NEAR(modes.house[0] / one.house[0], 1.0, 1e-3);
  EXPECT_NEAR(modes.tip[0] / modes.house[0], one.tip[0] / one.house[0], 1e-9);
}

}  // namespace
}  // namespace slewlab::sim
