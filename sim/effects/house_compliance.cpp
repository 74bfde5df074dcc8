// House compliance: the house twists between the slew ring, on which all pinions push, and the boom's pivot:
// two inertias on a spring,
//   J_ring theta_ring'' = sum T_gear - k_h (theta_ring - theta_h),
//   (J_h - J_ring) theta_h'' = k_h (theta_ring - theta_h) + T_boom.
// The ring is one more degree of freedom of the boom's modes: it costs one mode and is exact in the step.
// Unlike a softer gearbox it does not show when the groups push against each other.
// Source: thesis (2.9), 34.9 GNm/rad as printed, 69.8 corrected (erratum E5).
#include "sim/effects/effect.h"

#include <limits>

namespace slewlab::sim {

namespace {

void change_house_compliance(const common::EffectValues& values, MachineParameters& parameters) {
  parameters.crane.house.stiffness = values["stiffness"];
  parameters.crane.house.ring_share = values["ring_share"];
}

}  // namespace

const EffectDescription& house_compliance() {
  static const EffectDescription description{
      .about = {.name = "house_compliance",
                .subsystem = common::Subsystem::house,
                .physics = "the crane house twists between slew ring and boom pivot",
                .parameters = {{.name = "stiffness",
                                .unit = common::Unit::newton_metre_per_radian,
                                .per = common::ScaleOf::gear_stiffness,
                                .meaning = "of the house in torsion, (2.9)",
                                .lower = 0.1497,
                                .upper = 149.8,
                                .typical = 1.498,
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
                                .absent = std::nullopt}},
                .needs = {.gears = true, .boom = true},
                .family = common::Family::elasticity},
      .ports = {EffectPort::parameters},
      .change = change_house_compliance};
  return description;
}

}  // namespace slewlab::sim
