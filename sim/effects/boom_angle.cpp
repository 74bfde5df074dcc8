// Boom angle: the boom stands higher or lower than the machine's file says. The radius at which rope and boom's mass move
// goes with the cosine, the boom's twist under what acts across it with the sine,
//   beta' = factor beta,  r_tip = r_pivot + l cos(beta'),
// and so do the places of the accelerometers on it; the rope keeps its length, a knuckle its bend, cylinders hold as they do there.
// No farther up or down than 1.5 rad: a boom does not pass the vertical.
// Source: geometry; the thesis has its crane at several angles (2.10, Table 4.2).
#include <algorithm>

#include "sim/effects/effect.h"
#include "sim/model/boom.h"

namespace slewlab::sim {

namespace {

constexpr double kSteepest = 1.5;  // [rad] chosen: where a boom leans against its stops

void change_boom_angle(const common::EffectValues& values, MachineParameters& parameters) {
  BoomParameters& boom = parameters.crane.boom;
  const double angle = std::clamp(values["factor"] * boom.angle, std::min(boom.angle, -kSteepest), std::max(boom.angle, kSteepest));
  boom = raised_boom(boom, angle - boom.angle);
}

}  // namespace

const EffectDescription& boom_angle() {
  static const EffectDescription description{
      .about = {.name = "boom_angle",
                .subsystem = common::Subsystem::boom,
                .physics = "the boom stands higher or lower than the file says",
                .parameters = {{.name = "factor",
                                .unit = common::Unit::none,
                                .meaning = "angle above the horizontal over the nominal one",
                                .lower = 0.5,
                                .upper = 1.6,
                                .typical = 1.1,
                                .prior_scale = 0.1,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = 1.0}},
                .needs = {.flexible_boom = true},
                .stands_for = {"boom angle"}},
      .ports = {EffectPort::parameters},
      .change = change_boom_angle};
  return description;
}

}  // namespace slewlab::sim
