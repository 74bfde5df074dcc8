// Coulomb friction of the slew bearing: a torque of constant size T_c against the house's motion, holding at rest. By direction, and with
// a give, as bearing_friction.h.
// Source: textbook. Not in the thesis.
#include "sim/effects/bearing_friction.h"

namespace slewlab::sim {

namespace {

struct CoulombLevel {
  double torque;  // [Nm]
  explicit CoulombLevel(const EffectStart& start) : torque(start.value("torque")) {}
  double operator()(const EffectMoment&) const { return torque; }
};

}  // namespace

const EffectDescription& bearing_coulomb() {
  static const EffectDescription description{
      .about = {.name = "bearing_coulomb",
                .subsystem = common::Subsystem::house,
                .physics = "dry friction of the slew bearing",
                .parameters = {{.name = "torque",
                                .unit = common::Unit::newton_metre,
                                .per = common::ScaleOf::axis_torque,
                                .meaning = "friction, mean of both directions",
                                .lower = 0.0,
                                .upper = 0.7312,
                                .typical = 0.04874,
                                .prior_scale = 0.02437,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0},
                               asymmetry_parameter(),
                               bearing_give_parameter()},
                .family = common::Family::friction},
      .ports = {EffectPort::friction, EffectPort::force},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<BearingFriction<CoulombLevel>>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
