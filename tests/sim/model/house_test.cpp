#include "sim/model/house.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace slewlab::sim {
namespace {

TEST(House, InertiaAndFrequencyOfTable23) {
  const double inertia = house_inertia(138000.0, 2.7);  // (2.8)
  EXPECT_NEAR(inertia, 2.52e5, 0.01e5);
  const double printed = house_stiffness_as_printed(81e9, 2.7, 0.12, 2.15);
  EXPECT_NEAR(printed, 34.9e9, 0.1e9);                          // Table 2.3 by (2.9) as printed
  EXPECT_NEAR(natural_frequency(printed, inertia), 59.0, 0.5);  // (2.10)
}

// E5: (2.9) prints 8 where a thin tube in torsion has 4. Judge: the exact polar moment of a tube,
// pi/32 (D_o^4 - D_i^4), whose thin limit is pi D^3 t / 4.
TEST(House, Erratum5ThinTubeInTorsion) {
  const double diameter = 2.7, wall = 0.012, height = 2.15, shear = 81e9;
  const double outer = std::pow(diameter + wall, 4), inner = std::pow(diameter - wall, 4);
  const double exact = shear * std::numbers::pi / 32.0 * (outer - inner) / height;
  EXPECT_NEAR(house_stiffness(shear, diameter, wall, height) / exact, 1.0, 1e-4);
  const double stiffness = house_stiffness(81e9, 2.7, 0.12, 2.15);
  EXPECT_NEAR(natural_frequency(stiffness, house_inertia(138000.0, 2.7)), 83.8, 0.3);  // 84 Hz, not 59
}

}  // namespace
}  // namespace slewlab::sim
