#include "sim/integrate/body_force.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// A field of 1 m/s^2 pushes with every mass once: boom and load in newtons, the rod with M L / 2.
TEST(BodyForce, PushesEveryMassOnce) {
  const CraneParameters crane = flexible_crane();
  PortForces ports;
  add_body_force(masses_of(crane), 1.0, ports);
  EXPECT_NEAR(ports.uniform_force * crane.boom.length, crane.boom.mass, 1e-9);
  EXPECT_EQ(ports.load_force, crane.load.mass);
  EXPECT_EQ(ports.rod_moment, 0.5 * crane.load.mass * crane.load.rod_length);
  EXPECT_EQ(ports.house_torque, 0.0);
}

// A load with a rod hangs straight along the field: rope and rod at the same angle.
TEST(BodyForce, RopeAndRodHangAlike) {
  CraneParameters crane = pendulum();
  crane.load.rod_length = 3.0;
  const auto samples = run(crane, "heel", {0.02, 1.0}, 0.01);
  const double field = 9.81 * std::sin(0.02) * std::sin(1.0);
  EXPECT_NEAR(samples.back().rope_angle, field / 9.81, 1e-9);
  EXPECT_NEAR(samples.back().rod_angle, field / 9.81, 1e-9);
}

}  // namespace
}  // namespace slewlab::sim
