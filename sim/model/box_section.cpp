#include "sim/model/box_section.h"

namespace slewlab::sim {
namespace {

double hollow(double across, double along, double inner_across, double inner_along) {
  return (along * across * across * across - inner_along * inner_across * inner_across * inner_across) / 12.0;
}

}  // namespace

double area(const BoxSection& box) {
  return box.width * box.height - (box.width - 2.0 * box.side_plate) * (box.height - 2.0 * box.flange_plate);
}

double lateral_second_moment(const BoxSection& box) {
  return hollow(box.width, box.height, box.width - 2.0 * box.side_plate, box.height - 2.0 * box.flange_plate);
}

double vertical_second_moment(const BoxSection& box) {
  return hollow(box.height, box.width, box.height - 2.0 * box.flange_plate, box.width - 2.0 * box.side_plate);
}

double torsion_constant(const BoxSection& box) {
  const double across = box.width - box.side_plate, along = box.height - box.flange_plate;
  const double enclosed = across * along;
  return 4.0 * enclosed * enclosed / (2.0 * across / box.flange_plate + 2.0 * along / box.side_plate);
}

double polar_radius_square(const BoxSection& box) {
  return (lateral_second_moment(box) + vertical_second_moment(box)) / area(box);
}

}  // namespace slewlab::sim
