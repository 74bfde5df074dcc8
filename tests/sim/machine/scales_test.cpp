// Scales against the thesis's own numbers and closed forms, and under the two scalings of a machine that must not
// change what they say: masses and forces by a factor; lengths by lambda with times by sqrt(lambda).
#include "sim/machine/scales.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/sim/scaled_crane.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::sim {
namespace {

TEST(Scales, AreTheThesissOwnNumbers) {
  const Scales scales = scales_of(thesis_crane());
  EXPECT_NEAR(scales.ratio, 2735.58, 1e-9);                       // thesis 2.10: 215.4 * 12.7
  EXPECT_NEAR(scales.axis_torque, 6.0 * 250.0 * 2735.58, 1e-6);   // six motors of T100
  EXPECT_NEAR(scales.motor_inertia, 1.167, 1e-12);                // thesis Table 2.6
  EXPECT_NEAR(scales.axis_inertia - scales.driven_inertia, 6.0 * 1.167 * 2735.58 * 2735.58, 1e-3);
  // thesis 2.10: the boom's inertia at 50 deg is 3.39e7; at 53.5 deg less, and the house adds 2.52e5
  EXPECT_GT(scales.driven_inertia, 2.5e7);
  EXPECT_LT(scales.driven_inertia, 3.4e7);
  EXPECT_NEAR(scales.reach, 3.6 + 46.6 * std::cos(53.5 * 3.14159265358979 / 180.0), 1e-9);
  EXPECT_NEAR(scales.acceleration_time, scales.axis_inertia * 0.05 / scales.axis_torque, 1e-12);
}

TEST(Scales, FollowMassesAndForcesAndKeepTimes) {
  const Scales one = scales_of(thesis_crane());
  for (const double factor : {1e-6, 1e-3, 1e3}) {
    const Scales scaled = scales_of(with_masses_times(thesis_crane(), factor));
    EXPECT_NEAR(scaled.axis_torque / one.axis_torque / factor, 1.0, 1e-12);
    EXPECT_NEAR(scaled.axis_inertia / one.axis_inertia / factor, 1.0, 1e-12);
    EXPECT_NEAR(scaled.acceleration_time / one.acceleration_time, 1.0, 1e-12);
    EXPECT_EQ(scaled.reach, one.reach);
    const std::vector<double> modes = structural_modes(thesis_crane(), 5);
    const std::vector<double> scaled_modes = structural_modes(with_masses_times(thesis_crane(), factor), 5);
    ASSERT_EQ(modes.size(), scaled_modes.size());
    for (std::size_t k = 0; k < modes.size(); ++k) EXPECT_NEAR(scaled_modes[k] / modes[k], 1.0, 1e-6);
  }
}

TEST(Scales, FollowLengthsWithTimesByTheirRoot) {
  const Scales one = scales_of(thesis_crane());
  const std::vector<double> modes = structural_modes(thesis_crane(), 5), swings = pendulum_modes(thesis_crane());
  for (const double lambda : {0.1, 4.0}) {
    const CraneParameters crane = with_lengths_times(thesis_crane(), lambda);
    const Scales scaled = scales_of(crane);
    EXPECT_NEAR(scaled.acceleration_time / one.acceleration_time / std::sqrt(lambda), 1.0, 1e-12);
    EXPECT_NEAR(scaled.reach / one.reach / lambda, 1.0, 1e-12);
    EXPECT_NEAR(scaled.top_speed / one.top_speed * std::sqrt(lambda), 1.0, 1e-12);
    const std::vector<double> scaled_modes = structural_modes(crane, 5), scaled_swings = pendulum_modes(crane);
    for (std::size_t k = 0; k < modes.size(); ++k) EXPECT_NEAR(scaled_modes[k] / modes[k] * std::sqrt(lambda), 1.0, 1e-6);
    for (std::size_t k = 0; k < swings.size(); ++k) EXPECT_NEAR(scaled_swings[k] / swings[k] * std::sqrt(lambda), 1.0, 1e-6);
  }
}

// 1.3 periods of the thesis's lowest mode, 1.31 Hz (Table 4.1), are more than it takes to top speed; a stiff machine has the latter alone.
TEST(Scales, TheCharacteristicTimeIsTheSlowerOfDriveAndStructure) {
  const Scales scales = scales_of(thesis_crane());
  EXPECT_NEAR(characteristic_time(thesis_crane()), 1.3 / 1.31, 0.05 * 1.3 / 1.31);
  EXPECT_EQ(characteristic_time(scales, {}), scales.acceleration_time);
  EXPECT_EQ(characteristic_time(scales, {1e3}), scales.acceleration_time);
  EXPECT_EQ(characteristic_time(scales, {0.5, 0.1}), 1.3 / 0.5);
}

TEST(Scales, ModesThatMatterAreTheThesiss) {
  const std::vector<double> modes = structural_modes(thesis_crane(), 6);
  ASSERT_EQ(modes.size(), 6u);
  // thesis Tables 4.1, 4.2: bending 1.31, 5.24, 13.2, 23.3 Hz, first torsion 10.4 Hz; the tolerance is the thesis's own
  for (const double known : {1.31, 5.24, 10.4, 13.2, 23.3}) {
    const bool is_there = std::any_of(modes.begin(), modes.end(), [&](double mode) { return std::fabs(mode - known) < 0.05 * known; });
    EXPECT_TRUE(is_there) << known << " Hz";
  }
}

TEST(Scales, AMachineWithoutRatingHasNone) {
  CraneParameters crane = thesis_crane();
  crane.drive.rated_torque = 0.0;
  EXPECT_THROW(scales_of(crane), std::invalid_argument);
}

}  // namespace
}  // namespace slewlab::sim
