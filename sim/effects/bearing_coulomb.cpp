#include "sim/effects/bearing_coulomb.h"

#include "sim/effects/asymmetry.h"
#include "sim/effects/presliding.h"

namespace slewlab::sim {

namespace {

class BearingCoulomb : public Running<BearingCoulomb> {
 public:
  explicit BearingCoulomb(const EffectStart& start)
      : positive_(start.values[0] * (1.0 + start.values[1])),
        negative_(start.values[0] * (1.0 - start.values[1])),
        joint_{.give = start.values[2]} {}

  void friction(const EffectMoment&, FrictionLevels& levels) override {
    if (joint_.give > 0.0) return;
    levels.house_positive += positive_;
    levels.house_negative += negative_;
  }

  void force(const EffectMoment& moment, PortForces& forces) override {
    if (joint_.give == 0.0) return;
    const double share = presliding_share(joint_, moment.house_angle);
    forces.house_torque -= share * (share > 0.0 ? positive_ : negative_);
  }

 private:
  double positive_;
  double negative_;
  Presliding joint_;
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
                               asymmetry_parameter(),
                               give_parameter("slew angle over which the bearing takes up its friction; 0: dry friction", 1e-3, 3e-5)}},
      .ports = {EffectPort::friction, EffectPort::force},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<BearingCoulomb>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
