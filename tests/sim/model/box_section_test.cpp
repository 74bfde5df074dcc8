#include "sim/model/box_section.h"

#include <gtest/gtest.h>

namespace slewlab::sim {
namespace {

// Four plates one by one: each its own area and moment, and Steiner's part of its distance.
TEST(BoxSection, IsItsPlates) {
  const BoxSection box{.width = 1.6, .height = 2.4, .side_plate = 0.012, .flange_plate = 0.02};
  const double side_height = 2.4 - 2.0 * 0.02, side = side_height * 0.012, flange = 1.6 * 0.02;
  EXPECT_NEAR(area(box) / (2.0 * side + 2.0 * flange), 1.0, 1e-13);
  const double side_distance = 0.5 * (1.6 - 0.012), flange_distance = 0.5 * (2.4 - 0.02);
  const double lateral = 2.0 * (side_height * 0.012 * 0.012 * 0.012 / 12.0 + side * side_distance * side_distance) +
                         2.0 * 0.02 * 1.6 * 1.6 * 1.6 / 12.0;
  const double vertical = 2.0 * 0.012 * side_height * side_height * side_height / 12.0 +
                          2.0 * (1.6 * 0.02 * 0.02 * 0.02 / 12.0 + flange * flange_distance * flange_distance);
  EXPECT_NEAR(lateral_second_moment(box) / lateral, 1.0, 1e-12);
  EXPECT_NEAR(vertical_second_moment(box) / vertical, 1.0, 1e-12);
  EXPECT_NEAR(polar_radius_square(box) / ((lateral + vertical) / area(box)), 1.0, 1e-12);
}

// A square tube of one thickness: Bredt gives a^3 t with the middle line's side a (textbook).
TEST(BoxSection, TorsionOfASquareTube) {
  EXPECT_NEAR(torsion_constant({.width = 1.01, .height = 1.01, .side_plate = 0.01, .flange_plate = 0.01}), 0.01, 1e-15);
}

}  // namespace
}  // namespace slewlab::sim
