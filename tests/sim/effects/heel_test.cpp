#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/integrate/machine.h"
#include "sim/machine/effect_scales.h"
#include "tests/sim/effects/effect_bench.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::sim {
namespace {

// The load hangs along gravity, and an accelerometer at rest reads gravity's part.
TEST(Heel, LoadHangsAlongGravity) {
  constexpr double kAngle = 0.02;
  const auto samples = run(pendulum(), "heel", {kAngle, std::numbers::pi / 2.0}, 5.0);
  EXPECT_NEAR(samples.back().rope_angle, std::sin(kAngle), 1e-9);
  EXPECT_NEAR(samples.back().load_velocity, 0.0, 1e-9);
  EXPECT_NEAR(samples.back().readings.tip_acceleration, -9.81 * std::sin(kAngle), 1e-9);
}

// Turned by hand before the run, the load hangs as gravity has it at that angle of the house, or straight where the boom points downhill.
TEST(Heel, LoadOfAMachineThatIsTurnedHangsAlongGravityThere) {
  constexpr double kAngle = 0.02, kDirection = std::numbers::pi / 2.0;
  for (const double turned : {0.5, kDirection}) {
    Machine machine = make_machine({.crane = pendulum(), .effects = {{"heel", {kAngle, kDirection}}}, .scales = effect_scales(thesis_crane())});
    machine.state.q[0] = turned / machine.model.house[0];
    machine.state.motor_angle.fill(turned);
    refresh(machine.model, machine.state);
    rest_under_steady_forces(machine);
    EXPECT_NEAR(rope_angle(machine), std::sin(kAngle) * std::sin(kDirection - turned), 1e-9);
  }
}

// A rigid boom is pushed downhill by its weight at its centre's radius.
TEST(Heel, PushesTheBoomDownhill) {
  const CraneParameters crane = rigid_crane();
  constexpr double kAngle = 0.02, kDirection = 0.6;
  const auto samples = run(crane, "heel", {kAngle, kDirection}, 0.05);
  const double centre = crane.boom.pivot_radius + 0.5 * crane.boom.length * std::cos(crane.boom.angle);
  const double expected = crane.boom.mass * 9.81 * std::sin(kAngle) * std::sin(kDirection) * centre /
                          house_and_boom_inertia(crane);
  EXPECT_NEAR(samples.back().house_speed / 0.05, expected, 1e-4 * expected);
}

}  // namespace
}  // namespace slewlab::sim
