// Stribeck friction of the slew bearing: dry friction that falls from its breakaway value as motion begins,
//   |T| <= (1 +- a) (T_c + T_s exp(-(omega / omega_s)^2)),   + against positive motion,
// holding at rest. T_s is the excess of breakaway over sliding. With `give` > 0 as bearing_coulomb.h.
// Source: textbook (Stribeck curve); bearing friction is not in the thesis.
#include "sim/effects/effect.h"

#include <cmath>

#include "sim/effects/asymmetry.h"
#include "sim/effects/presliding.h"

namespace slewlab::sim {

namespace {

class BearingStribeck : public Running<BearingStribeck> {
 public:
  explicit BearingStribeck(const EffectStart& start)
      : coulomb_(start.value("coulomb_torque")),
        excess_(start.value("breakaway_excess")),
        speed_(start.value("stribeck_speed")),
        asymmetry_(start.value("asymmetry")),
        joint_{.give = start.value("give")} {}

  void friction(const EffectMoment& moment, FrictionLevels& levels) override {
    if (joint_.give > 0.0) return;
    const double sliding = level(moment.house_speed);
    levels.house_positive += (1.0 + asymmetry_) * sliding;
    levels.house_negative += (1.0 - asymmetry_) * sliding;
  }

  void force(const EffectMoment& moment, PortForces& forces) override {
    if (joint_.give == 0.0) return;
    const double share = presliding_share(joint_, moment.house_angle);
    forces.house_torque -= share * (share > 0.0 ? 1.0 + asymmetry_ : 1.0 - asymmetry_) * level(moment.house_speed);
  }

 private:
  double level(double house_speed) const {
    const double ratio = house_speed / speed_;
    return coulomb_ + excess_ * std::exp(-ratio * ratio);
  }

  double coulomb_;
  double excess_;
  double speed_;
  double asymmetry_;
  Presliding joint_;
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
                               give_parameter("slew angle over which the bearing takes up its friction; 0: dry friction",
                                              common::ScaleOf::axis_angle, 0.01986, 5.955e-4)},
                .family = common::Family::friction},
      .ports = {EffectPort::friction, EffectPort::force},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<BearingStribeck>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
