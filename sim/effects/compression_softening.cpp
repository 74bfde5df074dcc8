// Softening by compression: the boom carries F_C along its axis, which takes bending stiffness away.
// (2.15) for a homogeneous boom,
//   f_C = f sqrt(1 - F_C / F_cr),   F_cr = pi^2 E I / L^2 (2.16),
// is the same as E I - F_C L^2 / pi^2 in place of E I. Taken at every station of the profile, so that the
// slender tip loses a larger share than the root: I falls by the half width, pi (D^2 - d^2) w^2. The polar
// inertia of the section is kept. Throws where a station would have no stiffness left.
// Source: thesis (2.15), (2.16); left out in 2.8 (at most 8.5 MN).
#include "sim/effects/effect.h"

#include <cmath>
#include <numbers>

#include "sim/model/cannot_be_built.h"

namespace slewlab::sim {

namespace {

void change_compression_softening(const common::EffectValues& values, MachineParameters& parameters) {
  BoomParameters& boom = parameters.crane.boom;
  if (values["compression"] == 0.0 || boom.element_count == 0) return;
  if (boom.type == BoomType::box_girder || boom.type == BoomType::knuckle) {
    throw CannotBeBuilt("effect compression_softening: it takes its share off the chords of a lattice; a box has none");
  }
  const double area = (boom.type == BoomType::a_frame ? 0.5 : 1.0) * std::numbers::pi * (boom.chord_outer_diameter * boom.chord_outer_diameter -
                                          boom.chord_inner_diameter * boom.chord_inner_diameter);
  const double lost_moment =
      values["compression"] * boom.length * boom.length / (std::numbers::pi * std::numbers::pi * boom.youngs_modulus);
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
                                .per = common::ScaleOf::force,
                                .meaning = "axial force",
                                .lower = 0.0,
                                .upper = 68.7,
                                .typical = 30.53,
                                .prior_scale = 11.45,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0}},
                .needs = {.flexible_boom = true},
                .family = common::Family::elasticity},
      .ports = {EffectPort::parameters},
      .change = change_compression_softening};
  return description;
}

}  // namespace slewlab::sim
