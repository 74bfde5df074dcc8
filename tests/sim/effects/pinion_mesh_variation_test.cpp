#include <gtest/gtest.h>

#include <numbers>
#include <stdexcept>
#include <vector>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// At the top of the sine the gears are 1 + a times as stiff, at its bottom 1 - a.
TEST(PinionMeshVariation, StiffensTheGearsAtItsTop) {
  const CraneParameters crane = fixed_house();
  const auto samples =
      run(crane, "pinion_mesh_variation", {0.1, std::numbers::pi / 2.0, -std::numbers::pi / 2.0, 0.0, 0.0, 0.0}, 6.0, constant_drive(100.0, 100.0));
  const double wound = 100.0 * torque_factor(crane) / group_gear_stiffness(crane);
  EXPECT_NEAR(samples.back().deflection[0], group_half_play(crane) + wound / 1.1, 1e-9 * wound);
  EXPECT_NEAR(samples.back().deflection[1], group_half_play(crane) + wound / 0.9, 1e-9 * wound) << "whose phase is at the bottom";
}

// (2.3), Table 2.1: 12 teeth at 0.1 Hz of the pinion mesh at 1.2 Hz. The groups wind each other up.
TEST(PinionMeshVariation, ComesAtTheMeshFrequency) {
  CraneParameters crane = rigid_crane();
  crane.drive.gear_damping_ratio = 0.5;
  const double torque = 100.0 * torque_factor(crane);
  const auto samples =
      run(crane, "pinion_mesh_variation", {0.1, 0.0, 0.0, 0.0, 0.0, 0.0}, 12.0, constant_drive(100.0, -100.0),
          {.slew_speed = 2.0 * std::numbers::pi * 0.1 / 12.7, .gear_torque = {torque, -torque}});
  const double mean = group_half_play(crane) + torque / group_gear_stiffness(crane);
  const std::vector<BenchSample> settled(samples.begin() + 3000, samples.end());
  const double period = period_of(settled, [&](const BenchSample& s) { return s.deflection[0] - mean; });
  EXPECT_NEAR(1.0 / period, 1.2, 0.01);
}

// The same pinion with twice the teeth meshes twice as often.
TEST(PinionMeshVariation, GoesWithTheMachinesTeeth) {
  CraneParameters crane = rigid_crane();
  crane.drive.gear_damping_ratio = 0.5;
  crane.drive.pinion_teeth = 24;
  const double torque = 100.0 * torque_factor(crane);
  const auto samples =
      run(crane, "pinion_mesh_variation", {0.1, 0.0, 0.0, 0.0, 0.0, 0.0}, 12.0, constant_drive(100.0, -100.0),
          {.slew_speed = 2.0 * std::numbers::pi * 0.1 / 12.7, .gear_torque = {torque, -torque}});
  const double mean = group_half_play(crane) + torque / group_gear_stiffness(crane);
  const std::vector<BenchSample> settled(samples.begin() + 3000, samples.end());
  const double period = period_of(settled, [&](const BenchSample& s) { return s.deflection[0] - mean; });
  EXPECT_NEAR(1.0 / period, 2.4, 0.02);
}

// Of teeth that nobody has told, no mesh is computed.
TEST(PinionMeshVariation, SuitsAMachineWhoseTeethAreKnown) {
  CraneParameters crane = rigid_crane();
  crane.drive.pinion_teeth = 0;
  try {
    run(crane, "pinion_mesh_variation", {0.1, 0.0, 0.0, 0.0, 0.0, 0.0}, 0.1, constant_drive(100.0, -100.0));
    FAIL() << "was taken";
  } catch (const std::invalid_argument& refused) {
    EXPECT_STREQ(refused.what(), "effect pinion_mesh_variation needs pinion_teeth in its drive, which this machine has not");
  }
}

}  // namespace
}  // namespace slewlab::sim
