// Boom stiffness: bending and torsion stiffness are factor times the nominal ones (E and G), so that every
// frequency of the clamped boom goes with the square root of the factor. The damping ratio is kept.
//   E' = factor E,  G' = factor G,  f_i' = sqrt(factor) f_i
// Source: thesis 2.8 (chords only, bracings left out; (2.11)).
#include "sim/effects/effect.h"

namespace slewlab::sim {

namespace {

void change_boom_stiffness(const common::EffectValues& values, MachineParameters& parameters) {
  parameters.crane.boom.youngs_modulus *= values["factor"];
  parameters.crane.boom.shear_modulus *= values["factor"];
}

}  // namespace

const EffectDescription& boom_stiffness() {
  static const EffectDescription description{
      .about = {.name = "boom_stiffness",
                .subsystem = common::Subsystem::boom,
                .physics = "the boom is stiffer or softer than its chords say",
                .parameters = {{.name = "factor",
                                .unit = common::Unit::none,
                                .meaning = "stiffness over the nominal one",
                                .lower = 0.4,
                                .upper = 2.5,
                                .typical = 0.85,
                                .prior_scale = 0.1,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = 1.0}},
                .needs = {.flexible_boom = true},
                .family = common::Family::elasticity,
                .stands_for = {"boom bending stiffness", "boom torsional stiffness"}},
      .ports = {EffectPort::parameters},
      .change = change_boom_stiffness};
  return description;
}

}  // namespace slewlab::sim
