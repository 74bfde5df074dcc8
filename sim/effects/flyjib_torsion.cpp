// Eccentric torsion of a fly jib: a jib of mass m on the boom's tip, its centre and its sheave the
// distance e in front of the boom's axis. It moves with y_tip + e psi_tip, so that bending and torsion are
// coupled at the tip,
//   M_tip += m [1 e; e e^2] on [y, psi],
// and the rope hangs from there. The tip accelerometer stays on the boom's own tip, y_tip. Rigid jib;
// BoomParameters::jib_mass, jib_eccentricity.
// Source: textbook; the thesis's boom has no jib.
#include "sim/effects/effect.h"

namespace slewlab::sim {

namespace {

void change_flyjib_torsion(const common::EffectValues& values, MachineParameters& parameters) {
  parameters.crane.boom.jib_mass += values["mass"];
  parameters.crane.boom.jib_eccentricity += values["eccentricity"];
}

}  // namespace

const EffectDescription& flyjib_torsion() {
  static const EffectDescription description{
      .about = {.name = "flyjib_torsion",
                .subsystem = common::Subsystem::boom,
                .physics = "a fly jib in front of the boom's axis twists the boom",
                .parameters = {{.name = "mass",
                                .unit = common::Unit::kilogram,
                                .per = common::ScaleOf::mass,
                                .meaning = "of the jib",
                                .lower = 0.0,
                                .upper = 0.3559,
                                .typical = 0.03559,
                                .prior_scale = 0.02373,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0},
                               {.name = "eccentricity",
                                .unit = common::Unit::metre,
                                .per = common::ScaleOf::length,
                                .meaning = "of the jib's centre and sheave from the boom's axis",
                                .lower = 0.0,
                                .upper = 0.3193,
                                .typical = 0.1596,
                                .prior_scale = 0.06386,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0,
                                .tries = {0.07982}}},
                .needs = {.boom = true},
                .family = common::Family::mass},
      .ports = {EffectPort::parameters},
      .change = change_flyjib_torsion};
  return description;
}

}  // namespace slewlab::sim
