#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

TEST(EncoderQuantisation, ReadsWholeCountsAndTheirDifference) {
  constexpr double kResolution = 0.01, kWindow = 0.005, kSlew = 0.0123;
  const CraneParameters crane = rigid_crane();
  const auto samples =
      run(crane, "encoder_quantisation", {kResolution, kWindow}, 2.0, no_drive, {.slew_speed = kSlew});
  const double shaft = kSlew * torque_factor(crane) / crane.drive.motors_per_group;
  double mean = 0.0;
  for (std::size_t k = 5; k < samples.size(); ++k) {
    const PlantReadings& readings = samples[k].readings;
    const double counts = readings.shaft_position[0] / kResolution;
    EXPECT_NEAR(counts, std::round(counts), 1e-6);
    EXPECT_NEAR(readings.shaft_position[0], shaft * samples[k].time - 0.5 * kResolution,
                0.5 * kResolution + 1e-9);
    // At a steady speed it is the counts' difference over the window.
    const double difference = readings.shaft_position[0] - samples[k - 5].readings.shaft_position[0];
    EXPECT_NEAR(readings.shaft_speed[0], difference / kWindow, 1e-6);
    mean += readings.shaft_speed[0];
  }
  EXPECT_NEAR(mean / static_cast<double>(samples.size() - 5), shaft, kResolution / 1.9);
}

}  // namespace
}  // namespace slewlab::sim
