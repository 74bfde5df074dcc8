#include "sim/model/house.h"

#include <cmath>
#include <numbers>

namespace slewlab::sim {

double house_inertia(double mass, double diameter) { return 0.25 * mass * diameter * diameter; }

double house_stiffness_as_printed(double shear_modulus, double diameter, double wall, double height) {
  return std::numbers::pi * shear_modulus * diameter * diameter * diameter * wall / (8.0 * height);
}

double house_stiffness(double shear_modulus, double diameter, double wall, double height) {
  return 2.0 * house_stiffness_as_printed(shear_modulus, diameter, wall, height);
}

double natural_frequency(double stiffness, double inertia) {
  return std::sqrt(stiffness / inertia) / (2.0 * std::numbers::pi);
}

}  // namespace slewlab::sim
