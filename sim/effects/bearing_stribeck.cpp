// Stribeck friction of the slew bearing: dry friction that falls from its breakaway value as motion begins,
//   T_c + T_s exp(-(omega / omega_s)^2),
// holding at rest. T_s is the excess of breakaway over sliding. By direction, and with a give, as bearing_friction.h.
// Source: textbook (Stribeck curve); bearing friction is not in the thesis.
#include "sim/effects/bearing_friction.h"

#include <cmath>

namespace slewlab::sim {

namespace {

struct StribeckLevel {
  double coulomb, excess;  // [Nm]
  double speed;            // [rad/s]
  explicit StribeckLevel(const EffectStart& start)
      : coulomb(start.value("coulomb_torque")), excess(start.value("breakaway_excess")), speed(start.value("stribeck_speed")) {}
  double operator()(const EffectMoment& moment) const {
    const double ratio = moment.house_speed / speed;
    return coulomb + excess * std::exp(-ratio * ratio);
  }
};

}  // namespace

const EffectDescription& bearing_stribeck() {
  static const EffectDescription description{
      .about = {.name = "bearing_stribeck",
                .subsystem = common::Subsystem::house,
                .physics = "dry friction of the slew bearing that falls as motion begins",
                .parameters = {{.name = "coulomb_torque",
                                .unit = common::Unit::newton_metre,
                                .per = common::ScaleOf::axis_torque,
                                .meaning = "friction while sliding, mean of both directions",
                                .lower = 0.0,
                                .upper = 0.7312,
                                .typical = 0.03656,
                                .prior_scale = 0.02437,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0},
                               {.name = "breakaway_excess",
                                .unit = common::Unit::newton_metre,
                                .per = common::ScaleOf::axis_torque,
                                .meaning = "friction at rest above that while sliding",
                                .lower = 0.0,
                                .upper = 0.4875,
                                .typical = 0.03656,
                                .prior_scale = 0.02437,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0},
                               {.name = "stribeck_speed",
                                .unit = common::Unit::radian_per_second,
                                .per = common::ScaleOf::axis_speed,
                                .meaning = "slewing speed at which the excess has fallen to 37 %",
                                .lower = 0.004,
                                .upper = 2.0,
                                .typical = 0.1,
                                .prior_scale = 0.5,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = std::nullopt},
                               asymmetry_parameter(),
                               bearing_give_parameter()},
                .family = common::Family::friction,
                .parts = [](const common::EffectValues& values) { return dry(values["coulomb_torque"], values); }},
      .ports = {EffectPort::friction, EffectPort::force},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<BearingFriction<StribeckLevel>>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
