#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// Nothing else acts: the rigid crane gains T / J of speed in every second, to either side.
TEST(TorqueOffset, AcceleratesTheAxis) {
  CraneParameters crane = rigid_crane();
  crane.drive.gear_damping_ratio = 0.5;
  crane.drive.gearbox_play = crane.drive.pinion_play = 0.0;
  for (const double torque : {2e5, -1e5}) {
    const auto samples = run(crane, "torque_offset", {torque}, 6.0);
    const double expected = torque / whole_inertia(crane);
    EXPECT_NEAR((samples[5999].house_speed - samples[1999].house_speed) / 4.0, expected, 1e-6 * std::fabs(expected));
  }
}

}  // namespace
}  // namespace slewlab::sim
