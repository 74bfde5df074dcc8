// Friction of the axis that rises steeply from rest and flattens: grease and seals that build their film within the first
// share of the speed, where a line through the origin (bearing_viscous) would go on to rise,
//   |T| <= (1 +- a) T_f (s + (1 - s) (1 - exp(-|omega| / omega_f))),   + against positive motion,
// holding s T_f at rest; T_f is what it flattens to.
// Source: chosen as the simplest law that saturates; the Stribeck curve's counterpart. Not in the thesis.
#include "sim/effects/effect.h"

#include <cmath>

#include "sim/effects/asymmetry.h"

namespace slewlab::sim {

namespace {

class BearingRising : public Running<BearingRising> {
 public:
  explicit BearingRising(const EffectStart& start)
      : torque_(start.value("torque")), speed_(start.value("speed")), at_rest_(start.value("at_rest")), asymmetry_(start.value("asymmetry")) {}

  void friction(const EffectMoment& moment, FrictionLevels& levels) override {
    const double level = torque_ * (at_rest_ - (1.0 - at_rest_) * std::expm1(-std::fabs(moment.house_speed) / speed_));
    levels.house_positive += (1.0 + asymmetry_) * level;
    levels.house_negative += (1.0 - asymmetry_) * level;
  }

 private:
  double torque_;   // [Nm]
  double speed_;    // [rad/s]
  double at_rest_;  // [-]
  double asymmetry_;
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
                               asymmetry_parameter()},
                .family = common::Family::friction},
      .ports = {EffectPort::friction},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<BearingRising>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
