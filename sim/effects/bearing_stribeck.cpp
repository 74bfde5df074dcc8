#include "sim/effects/bearing_stribeck.h"

#include <cmath>

namespace slewlab::sim {

namespace {

class BearingStribeck : public Running<BearingStribeck> {
 public:
  explicit BearingStribeck(const EffectStart& start)
      : coulomb_(start.values[0]),
        excess_(start.values[1]),
        speed_(start.values[2]),
        asymmetry_(start.values[3]) {}

  void friction(const EffectMoment& moment, FrictionLevels& levels) override {
    const double ratio = moment.house_speed / speed_;
    const double level = coulomb_ + excess_ * std::exp(-ratio * ratio);
    levels.house_positive += (1.0 + asymmetry_) * level;
    levels.house_negative += (1.0 - asymmetry_) * level;
  }

 private:
  double coulomb_;
  double excess_;
  double speed_;
  double asymmetry_;
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
                               {.name = "asymmetry",
                                .unit = common::Unit::none,
                                .meaning = "relative excess against positive motion, lack against negative",
                                .lower = -1.0,
                                .upper = 1.0,
                                .typical = 0.0,
                                .prior_scale = 0.2,
                                .scale = common::ParameterScale::linear,
                                .absent = std::nullopt}}},
      .ports = {EffectPort::friction},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<BearingStribeck>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
