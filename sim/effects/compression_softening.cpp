#include "sim/effects/compression_softening.h"

#include <cmath>
#include <numbers>

#include "sim/model/cannot_be_built.h"

namespace slewlab::sim {

namespace {

void change(EffectValues values, MachineParameters& parameters) {
  BoomParameters& boom = parameters.crane.boom;
  if (values[0] == 0.0 || boom.element_count == 0) return;
  const double area = std::numbers::pi * (boom.chord_outer_diameter * boom.chord_outer_diameter -
                                          boom.chord_inner_diameter * boom.chord_inner_diameter);
  const double lost_moment =
      values[0] * boom.length * boom.length / (std::numbers::pi * std::numbers::pi * boom.youngs_modulus);
  const double lost_square = lost_moment / area;  // [m^2] of the half width squared
  for (BoomStation& station : boom.profile) {
    const double square = station.half_width * station.half_width - lost_square;
    if (square <= 0.0) {
      throw CannotBeBuilt("effect compression_softening: the boom buckles under this compression");
    }
    station.half_width = std::sqrt(square);
    station.half_height = std::sqrt(station.half_height * station.half_height + lost_square);
  }
}

}  // namespace

const EffectDescription& compression_softening() {
  static const EffectDescription description{
      .about = {.name = "compression_softening",
                .subsystem = common::Subsystem::boom,
                .physics = "compression along the boom lowers its bending stiffness",
                .parameters = {{.name = "compression",
                                .unit = common::Unit::newton,
                                .meaning = "axial force",
                                .lower = 0.0,
                                .upper = 9e6,
                                .typical = 4e6,
                                .prior_scale = 1.5e6,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0}}},
      .ports = {EffectPort::parameters},
      .change = change};
  return description;
}

}  // namespace slewlab::sim
