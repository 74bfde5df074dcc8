#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// Position by the formula; speed is its derivative. Second harmonic at twice each group's phase.
TEST(EncoderRipple, ErrsOnceAndTwicePerTurn) {
  constexpr double kAmplitude = 0.02, kPhase = 0.8, kLast = -1.7, kShare = 0.3, kSlew = 0.002;
  const CraneParameters crane = rigid_crane();
  const double shaft = kSlew * torque_factor(crane) / crane.drive.motors_per_group;
  for (const double second : {0.0, 0.4}) {
    const auto samples =
        run(crane, "encoder_ripple", {kAmplitude, kPhase, kLast, second, kShare}, 2.0, no_drive, {.slew_speed = kSlew});
    const auto error = [&](double angle, double phase) {
      return std::sin(angle + phase) - std::sin(phase) +
             second * (std::sin(2.0 * angle + 2.0 * phase) - std::sin(2.0 * phase));
    };
    for (std::size_t k = 1; k + 1 < samples.size(); ++k) {
      const double angle = shaft * samples[k].time;
      EXPECT_NEAR(samples[k].readings.shaft_position[0], angle + (1.0 + kShare) * kAmplitude * error(angle, kPhase), 1e-9);
      EXPECT_NEAR(samples[k].readings.shaft_position[1], angle + (1.0 - kShare) * kAmplitude * error(angle, kLast), 1e-9);
      const double slope =
          (samples[k + 1].readings.shaft_position[0] - samples[k - 1].readings.shaft_position[0]) / 0.002;
      EXPECT_NEAR(samples[k].readings.shaft_speed[0], slope, 5e-5);
    }
  }
}

}  // namespace
}  // namespace slewlab::sim
