// Friction of the axis that rises steeply from rest and flattens: grease and seals that build their film within the first
// share of the speed, where a line through the origin (bearing_viscous) would go on to rise,
//   T_f (s + (1 - s) (1 - exp(-|omega| / omega_f))),
// holding s T_f at rest; T_f is what it flattens to. By direction, and with a give, as bearing_friction.h.
// Source: chosen as the simplest law that saturates; the Stribeck curve's counterpart. Not in the thesis.
#include "sim/effects/bearing_friction.h"

#include <cmath>

namespace slewlab::sim {

namespace {

struct RisingLevel {
  double torque;   // [Nm]
  double speed;    // [rad/s]
  double at_rest;  // [-]
  explicit RisingLevel(const EffectStart& start) : torque(start.value("torque")), speed(start.value("speed")), at_rest(start.value("at_rest")) {}
  double operator()(const EffectMoment& moment) const {
    return torque * (at_rest - (1.0 - at_rest) * std::expm1(-std::fabs(moment.house_speed) / speed));
  }
};

}  // namespace

const EffectDescription& bearing_rising() {
  static const EffectDescription description{
      .about = {.name = "bearing_rising",
                .subsystem = common::Subsystem::house,
                .physics = "friction that rises steeply from rest and flattens",
                .parameters = {{.name = "torque",
                                .unit = common::Unit::newton_metre,
                                .per = common::ScaleOf::axis_torque,
                                .meaning = "friction at speed, mean of both directions",
                                .lower = 0.0,
                                .upper = 0.7312,
                                .typical = 0.05,
                                .prior_scale = 0.025,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0},
                               {.name = "speed",
                                .unit = common::Unit::radian_per_second,
                                .per = common::ScaleOf::axis_speed,
                                .meaning = "at which 63 % of the rise are reached",
                                .lower = 0.004,
                                .upper = 2.0,
                                .typical = 0.2,
                                .prior_scale = 0.7,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = std::nullopt,
                                .tries = {0.04}},
                               {.name = "at_rest",
                                .unit = common::Unit::none,
                                .meaning = "share of the friction that holds at rest",
                                .lower = 0.0,
                                .upper = 1.0,
                                .typical = 0.2,
                                .prior_scale = 0.3,
                                .scale = common::ParameterScale::linear,
                                .absent = std::nullopt},
                               asymmetry_parameter(),
                               bearing_give_parameter()},
                .family = common::Family::friction,
                // Slow beside the speed at which it flattens it is dry friction and a line.
                .parts = [](const common::EffectValues& values) {
                  return dry_and_viscous(values["at_rest"] * values["torque"], (1.0 - values["at_rest"]) * values["torque"] / values["speed"], values);
                }},
      .ports = {EffectPort::friction, EffectPort::force},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<BearingFriction<RisingLevel>>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
