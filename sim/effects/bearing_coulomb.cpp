#include "sim/effects/bearing_coulomb.h"

namespace slewlab::sim {

namespace {

class BearingCoulomb : public Running<BearingCoulomb> {
 public:
  explicit BearingCoulomb(const EffectStart& start)
      : positive_(start.values[0] * (1.0 + start.values[1])),
        negative_(start.values[0] * (1.0 - start.values[1])) {}

  void friction(const EffectMoment&, FrictionLevels& levels) override {
    levels.house_positive += positive_;
    levels.house_negative += negative_;
  }

 private:
  double positive_;
  double negative_;
};

}  // namespace

const EffectDescription& bearing_coulomb() {
  static const EffectDescription description{
      .about = {.name = "bearing_coulomb",
                .subsystem = common::Subsystem::house,
                .physics = "dry friction of the slew bearing",
                .parameters = {{.name = "torque",
                                .unit = common::Unit::newton_metre,
                                .meaning = "friction, mean of both directions",
                                .lower = 0.0,
                                .upper = 3e6,
                                .typical = 2e5,
                                .prior_scale = 1e5,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0},
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
        return std::make_unique<BearingCoulomb>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
