#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// A heavy house turned with a constant acceleration pushes the pedestal sideways all at once: step response
// of a damped oscillator, M y'' + c y' + k y = -M_boom r_centre a.
TEST(PedestalFlexibility, SwingsAsAnOscillator) {
  CraneParameters crane = rigid_crane();
  crane.house.inertia = 1e12;
  constexpr double kStiffness = 1e8, kTop = 3e5, kRatio = 0.02;
  const double torque = 100.0 * torque_factor(crane);
  const auto samples = run(crane, "pedestal_flexibility", {kStiffness, kTop, kRatio}, 2.0,
                           constant_drive(100.0, 100.0), {.gear_torque = {torque, torque}});
  const double acceleration = 2.0 * torque / whole_inertia(crane);
  const double mass = kTop + crane.boom.mass;
  const double natural = std::sqrt(kStiffness / mass);
  const double damped = natural * std::sqrt(1.0 - kRatio * kRatio);
  const double centre = crane.boom.pivot_radius + 0.5 * crane.boom.length * std::cos(crane.boom.angle);
  const double first = -crane.boom.mass * centre * acceleration / mass;
  for (std::size_t k = 100; k < samples.size(); k += 50) {
    const double t = samples[k].time;
    const double expected = first * std::exp(-kRatio * natural * t) *
                            (std::cos(damped * t) - kRatio * natural / damped * std::sin(damped * t));
    const double rigid = crane.house.sensor_radius * acceleration;
    EXPECT_NEAR(samples[k].readings.house_acceleration - rigid, expected, 0.01 * std::fabs(first)) << t;
  }
}

}  // namespace
}  // namespace slewlab::sim
