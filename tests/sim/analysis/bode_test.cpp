#include "sim/analysis/bode.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/model/boom.h"
#include "sim/model/crane.h"
#include "sim/model/drive_line.h"
#include "tests/sim/angles.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::sim {
namespace {

// A rigid boom on one group: two inertias, a spring and a damper, in closed form.
TEST(Bode, TwoMassesInClosedForm) {
  CraneParameters crane = thesis_crane(0);
  crane.load.mass = 0.0;
  crane.drive.group_count = 1;
  crane.drive.motors_per_group = 6;
  const double motor = group_inertia(crane.drive), driven = driven_inertia(crane);
  const GearContact gear = gear_contact(crane);
  const double torque = 6.0 * total_ratio(crane.drive);
  const std::vector<double> frequencies{0.05, 0.7, 2.9, 3.3, 40.0};
  const std::vector<BodePoint> response = frequency_response(crane, frequencies);
  for (std::size_t i = 0; i < frequencies.size(); ++i) {
    const std::complex<double> s(0.0, kTwoPi * frequencies[i]);
    const std::complex<double> mesh = gear.stiffness + gear.damping * s;
    const std::complex<double> house =
        torque * mesh / ((motor * s * s + mesh) * (driven * s * s + mesh) - mesh * mesh);
    const std::complex<double> exact = s * house * tip_radius(crane.boom);
    EXPECT_LT(std::abs(response[i].tip_velocity / exact - 1.0), 1e-9) << frequencies[i];
  }
}

// Far below the first mode the crane turns as one: velocity = torque * radius / (i w J).
TEST(Bode, SlowLimitIsTheRigidCrane) {
  CraneParameters crane = thesis_crane();
  crane.load.mass = 0.0;
  const double inertia = 2.0 * group_inertia(crane.drive) + driven_inertia(crane);
  const BodePoint point = frequency_response(crane, {0.01})[0];
  const std::complex<double> exact =
      6.0 * total_ratio(crane.drive) * tip_radius(crane.boom) / (std::complex<double>(0.0, kTwoPi * 0.01) * inertia);
  EXPECT_LT(std::abs(point.tip_velocity / exact - 1.0), 1e-3);
}

TEST(Bode, FrequenciesAreSpreadEvenlyOnALogarithmicScale) {
  const std::vector<double> frequencies = logarithmic_frequencies(0.1, 10.0, 5);
  ASSERT_EQ(frequencies.size(), 5u);
  EXPECT_NEAR(frequencies[2], 1.0, 1e-12);
  EXPECT_NEAR(frequencies[4], 10.0, 1e-12);
  EXPECT_NEAR(decibel({0.0, 0.1}), -20.0, 1e-12);
}

}  // namespace
}  // namespace slewlab::sim
