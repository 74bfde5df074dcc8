// Coulomb friction of the slew bearing: a torque of constant size against the house's motion, holding at
// rest,
//   |T| <= T_c (1 + a) against positive motion, T_c (1 - a) against negative.
// With `give` > 0 the bearing gives before it slides (presliding.h): torque T_c (1 +- a) s, + where the held share s is
// positive. That is continuous at s = 0, and more angle is more torque for every a.
// Source: textbook; "static friction" is in the calculations that thesis 1.1 calls current, and not in its
// model.
#include "sim/effects/effect.h"

#include "sim/effects/asymmetry.h"
#include "sim/effects/presliding.h"

namespace slewlab::sim {

namespace {

class BearingCoulomb : public Running<BearingCoulomb> {
 public:
  explicit BearingCoulomb(const EffectStart& start)
      : positive_(start.value("torque") * (1.0 + start.value("asymmetry"))),
        negative_(start.value("torque") * (1.0 - start.value("asymmetry"))),
        joint_{.give = start.value("give")} {}

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
                                .per = common::ScaleOf::axis_torque,
                                .meaning = "friction, mean of both directions",
                                .lower = 0.0,
                                .upper = 0.7312,
                                .typical = 0.04874,
                                .prior_scale = 0.02437,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0},
                               asymmetry_parameter(),
                               give_parameter("slew angle over which the bearing takes up its friction; 0: dry friction",
                                              common::ScaleOf::axis_angle, 0.01986, 5.955e-4)},
                .family = common::Family::friction},
      .ports = {EffectPort::friction, EffectPort::force},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<BearingCoulomb>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
