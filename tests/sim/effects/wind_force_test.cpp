#include "sim/effects/wind_force.h"

#include <gtest/gtest.h>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

TEST(WindForce, IsPressureTimesArea) {
  const CraneParameters crane = flexible_crane();
  PortForces ports;
  add_wind(drag_areas(crane, 80.0, 20.0), 3.0, 5.0, ports);
  EXPECT_NEAR(ports.uniform_force * crane.boom.length, 240.0, 1e-9);
  EXPECT_EQ(ports.load_force, 100.0);
}

TEST(WindForce, NothingToBlowOnIsNoForce) {
  CraneParameters crane = flexible_crane();
  crane.load = {};
  crane.boom.length = 0.0;
  PortForces ports;
  add_wind(drag_areas(crane, 80.0, 20.0), 3.0, 5.0, ports);
  EXPECT_EQ(ports.uniform_force, 0.0);
  EXPECT_EQ(ports.load_force, 0.0);
}

}  // namespace
}  // namespace slewlab::sim
