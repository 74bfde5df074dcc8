#include "sim/effects/bearing_stribeck.h"

#include <cmath>

#include "sim/effects/asymmetry.h"
#include "sim/effects/presliding.h"

namespace slewlab::sim {

namespace {

class BearingStribeck : public Running<BearingStribeck> {
 public:
  explicit BearingStribeck(const EffectStart& start)
      : coulomb_(start.values[0]),
        excess_(start.values[1]),
        speed_(start.values[2]),
        asymmetry_(start.values[3]),
        joint_{.give = start.values[4]} {}

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
                                .meaning = "friction while sliding, mean of both directions",
                                .lower = 0.0,
                                .upper = 3e6,
                                .typical = 1.5e5,
                                .prior_scale = 1e5,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0},
                               {.name = "breakaway_excess",
                                .unit = common::Unit::newton_metre,
                                .meaning = "friction at rest above that while sliding",
                                .lower = 0.0,
                                .upper = 2e6,
                                .typical = 1.5e5,
                                .prior_scale = 1e5,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0},
                               {.name = "stribeck_speed",
                                .unit = common::Unit::radian_per_second,
                                .meaning = "slewing speed at which the excess has fallen to 37 %",
                                .lower = 2e-4,
                                .upper = 0.1,
                                .typical = 0.005,
                                .prior_scale = 0.5,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = std::nullopt},
                               asymmetry_parameter(),
                               give_parameter("slew angle over which the bearing takes up its friction; 0: dry friction", 1e-3, 3e-5)}},
      .ports = {EffectPort::friction, EffectPort::force},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<BearingStribeck>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
