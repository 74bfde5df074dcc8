#include "sim/effects/encoder_ripple.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// Position by the formula; speed is its derivative.
TEST(EncoderRipple, ErrsOncePerTurn) {
  constexpr double kAmplitude = 0.02, kPhase = 0.8, kSlew = 0.002;
  const CraneParameters crane = rigid_crane();
  const auto samples =
      run(crane, "encoder_ripple", {kAmplitude, kPhase, kPhase}, 2.0, no_drive, {.slew_speed = kSlew});
  const double shaft = kSlew * torque_factor(crane) / crane.drive.motors_per_group;
  for (std::size_t k = 1; k + 1 < samples.size(); ++k) {
    const double angle = shaft * samples[k].time;
    EXPECT_NEAR(samples[k].readings.shaft_position[0],
                angle + kAmplitude * (std::sin(angle + kPhase) - std::sin(kPhase)), 1e-9);
    const double slope =
        (samples[k + 1].readings.shaft_position[0] - samples[k - 1].readings.shaft_position[0]) / 0.002;
    EXPECT_NEAR(samples[k].readings.shaft_speed[0], slope, 1e-5);
  }
}

}  // namespace
}  // namespace slewlab::sim
