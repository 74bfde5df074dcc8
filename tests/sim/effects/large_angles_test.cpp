#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "sim/machine/machine_file.h"
#include "tests/sim/effects/effect_bench.h"

namespace slewlab::sim {
namespace {

// Period of the pendulum by its series in the amplitude b: 1 + b^2/16 + 11 b^4/3072 + 173 b^6/737280.
TEST(LargeAngles, LengthenThePeriod) {
  constexpr double kAmplitude = 0.6;  // [rad]
  const auto samples =
      run(pendulum(), "large_angles", {1.0}, 100.0, no_drive, {.rope_angle = std::sin(kAmplitude)});
  const double b2 = kAmplitude * kAmplitude;
  const double series = 1.0 + b2 / 16.0 + 11.0 * b2 * b2 / 3072.0 + 173.0 * b2 * b2 * b2 / 737280.0;
  const double period = period_of(samples, [](const BenchSample& s) { return s.rope_angle; });
  EXPECT_NEAR(period / (2.0 * std::numbers::pi * std::sqrt(60.0 / 9.81)), series, 1e-5);
}

// A load that swings far holds its end of the boom as M sin(beta)^2 would, more than the boom's faster modes weigh there (three to eleven times on these
// cranes, at 0.3 rad). With a step a fifth as long the tip is led along five times faster; what a load does with its boom is the same.
TEST(LargeAngles, FeedNoModeOfALightBoom) {
  const auto swing = [](const std::string& crane, double step) {
    MachineSettings settings;
    settings.crane = load_machine_file(std::string(SLEWLAB_SOURCE_DIR) + "/config/cranes/" + crane + ".yaml").parameters;
    settings.step = step;
    settings.effects = {{"large_angles", {1.0}}};
    return run(settings, 60.0, no_drive, {.rope_angle = 0.3});
  };
  for (const char* crane : {"thesis", "harbour_5t", "offshore_900t"}) {
    const std::vector<BenchSample> coarse = swing(crane, 1e-3), fine = swing(crane, 2e-4);
    for (std::size_t k = 0; k < coarse.size(); ++k) {
      ASSERT_NEAR(coarse[k].rope_angle, fine[5 * k + 4].rope_angle, 3e-3) << crane << " at " << coarse[k].time;
    }
  }
}

}  // namespace
}  // namespace slewlab::sim
