#include "sim/effects/house_compliance.h"

#include <limits>

namespace slewlab::sim {

namespace {

void change(EffectValues values, MachineParameters& parameters) {
  parameters.crane.house.stiffness = values[0];
  parameters.crane.house.ring_share = values[1];
}

}  // namespace

const EffectDescription& house_compliance() {
  static const EffectDescription description{
      .about = {.name = "house_compliance",
                .subsystem = common::Subsystem::house,
                .physics = "the crane house twists between slew ring and boom pivot",
                .parameters = {{.name = "stiffness",
                                .unit = common::Unit::newton_metre_per_radian,
                                .meaning = "of the house in torsion, (2.9)",
                                .lower = 1e9,
                                .upper = 1e12,
                                .typical = 1e10,
                                .prior_scale = 1.0,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = std::numeric_limits<double>::infinity()},
                               {.name = "ring_share",
                                .unit = common::Unit::none,
                                .meaning = "share of the house's inertia that turns with the ring",
                                .lower = 0.05,
                                .upper = 0.9,
                                .typical = 0.2,
                                .prior_scale = 0.5,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = std::nullopt}}},
      .ports = {EffectPort::parameters},
      .change = change};
  return description;
}

}  // namespace slewlab::sim
