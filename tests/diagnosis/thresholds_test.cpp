#include "diagnosis/thresholds.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/diagnosis/scaled_machine.h"

namespace slewlab::diagnosis {
namespace {

// The thesis's crane: 1.0075 s to top speed; its eighth structural mode, the fifth of bending, at 37.9 Hz.
TEST(Thresholds, OfTheThesisCrane) {
  const Thresholds& thesis = bench().thresholds;
  EXPECT_NEAR(thesis.time, 1.0075, 1e-4);
  EXPECT_NEAR(thesis.whitening.highest_frequency, 40.0, 0.3);
  EXPECT_DOUBLE_EQ(thesis.admission.rated_torque, bench().crane.drive.rated_torque);
  EXPECT_NEAR(thesis.admission.radius[kTip], 31.3, 0.1);  // pivot radius and the boom's level length
}

// Edges between groups of modes: 0.3 | 1.3 1.8 | 5.2 | 10 13 | 23, by geometric means; what is not apart by half stays together.
TEST(Thresholds, EdgesGoBetweenTheModes) {
  const std::vector<double> edges = edges_between({0.06, 0.3}, {1.3, 1.8, 5.2, 10.0, 13.0, 23.0}, 0.02, 40.0);
  const std::vector<double> expected{0.02, std::sqrt(0.3 * 1.3), std::sqrt(1.8 * 5.2), std::sqrt(5.2 * 10.0), std::sqrt(13.0 * 23.0), 40.0};
  ASSERT_EQ(edges.size(), expected.size());
  for (std::size_t k = 0; k < edges.size(); ++k) EXPECT_DOUBLE_EQ(edges[k], expected[k]);
  EXPECT_EQ(edges_between({}, {}, 0.02, 40.0), (std::vector<double>{0.02, 40.0}));  // a rigid machine has no modes
  EXPECT_EQ(edges_between({}, {2.6, 60.0}, 0.02, 10.0), (std::vector<double>{0.02, 1.0, 10.0}));
}

// An observer follows what is read every 100 ms no faster than once per reading, critically damped as before.
TEST(Thresholds, AnObserverIsNotFasterThanItsReadings) {
  const ShadowSettings& given = bench().thresholds.shadow;
  EXPECT_EQ(not_faster_than(given, 1e-3).speed_rate, given.speed_rate);
  const ShadowSettings slow = not_faster_than(given, 0.1);
  EXPECT_DOUBLE_EQ(slow.speed_rate, 10.0);
  EXPECT_DOUBLE_EQ(slow.position_rate / (slow.speed_rate * slow.speed_rate), given.position_rate / (given.speed_rate * given.speed_rate));
}

class ThresholdsInAnotherSize : public testing::TestWithParam<Scaling> {};

// Dimensions: times go with the machine's, frequencies and rates against them, torques with its torques; nothing else.
TEST_P(ThresholdsInAnotherSize, GoWithTheMachine) {
  const Scaling scaling = GetParam();
  const Thresholds& own = bench().thresholds;
  const Thresholds other = thresholds_of(sim::describe(scaled(bench().crane, scaling)));
  const auto expect = [&](double value, double nominal, double factor, const char* what) {
    EXPECT_NEAR(value, nominal * factor, 1e-8 * std::fabs(nominal * factor)) << what;
  };
  const double time = scaling.root_time, torque = scaling.torque();
  expect(other.time, own.time, time, "time");
  expect(other.highest_mode, own.highest_mode, 1.0 / time, "highest mode");
  expect(other.latency, own.latency, time, "latency");
  expect(other.coarse_latency, own.coarse_latency, time, "coarse latency");
  expect(other.moment, own.moment, time, "moment");
  expect(other.spell_every, own.spell_every, time, "spells");
  ASSERT_EQ(other.band_edges.size(), own.band_edges.size());
  for (std::size_t k = 0; k < own.band_edges.size(); ++k) expect(other.band_edges[k], own.band_edges[k], 1.0 / time, "band edge");
  expect(other.admission.rated_torque, own.admission.rated_torque, torque, "rated torque");
  expect(other.admission.turn, own.admission.turn, 1.0, "turn");
  expect(other.admission.shortest_record, own.admission.shortest_record, time, "shortest record");
  expect(other.admission.frozen_time, own.admission.frozen_time, time, "frozen time");
  expect(other.admission.rate_half_width, own.admission.rate_half_width, time, "rate half width");
  expect(other.admission.speed_window, own.admission.speed_window, time, "speed window");
  expect(other.admission.slow, own.admission.slow, time, "slow");
  for (std::size_t a = 0; a < kAccelerometerCount; ++a) expect(other.admission.radius[a], own.admission.radius[a], scaling.length(), "radius");
  expect(other.shadow.speed_rate, own.shadow.speed_rate, 1.0 / time, "speed rate");
  expect(other.shadow.position_rate, own.shadow.position_rate, 1.0 / (time * time), "position rate");
  expect(other.shadow.tip_damping_rate, own.shadow.tip_damping_rate, 1.0 / time, "tip damping rate");
  expect(other.shadow.leak_time, own.shadow.leak_time, time, "leak time");
  expect(other.shadow.first_offset, own.shadow.first_offset, time, "first offset");
  expect(other.shadow.offset_time, own.shadow.offset_time, time, "offset time");
  expect(other.whitening.lowest_frequency, own.whitening.lowest_frequency, 1.0 / time, "lowest frequency");
  expect(other.whitening.highest_frequency, own.whitening.highest_frequency, 1.0 / time, "highest frequency");
  expect(other.whitening.encoder_noise_from, own.whitening.encoder_noise_from, 1.0 / time, "encoder noise");
  expect(other.whitening.before_impact, own.whitening.before_impact, time, "before an impact");
  expect(other.whitening.after_impact, own.whitening.after_impact, time, "after an impact");
  expect(other.whitening.soft_edge, own.whitening.soft_edge, time, "soft edge");
  expect(other.whitening.count_smoothing, own.whitening.count_smoothing, time, "count smoothing");
  expect(other.whitening.least_torque, own.whitening.least_torque, torque, "least torque");
  expect(other.whitening.least_acceleration, own.whitening.least_acceleration, 1.0, "least acceleration");
  EXPECT_EQ(other.whitening.noise_corner, own.whitening.noise_corner);  // the sensor's, not the machine's
}

INSTANTIATE_TEST_SUITE_P(Sizes, ThresholdsInAnotherSize,
                         testing::Values(Scaling{1e-6, 1.0}, Scaling{1e-3, 1.0}, Scaling{1e3, 1.0}, Scaling{1.0, 0.316228}, Scaling{1.0, 2.0}));

}  // namespace
}  // namespace slewlab::diagnosis
