// Dry friction of the slew bearing, of whatever level: not the same in both directions, and giving before it slides,
//   |T| <= (1 +- a) T_f,   + against positive motion,
// holding at rest. T_f is the level, a law of its own for each effect. With `give` > 0 the bearing gives before it slides (presliding.h):
// torque (1 +- a) T_f s, + where the held share s is positive. That is continuous at s = 0, and more angle is more torque for every a.
// Source: textbook; "static friction" is in the calculations that thesis 1.1 calls current, and not in its model.
#pragma once

#include "sim/effects/asymmetry.h"
#include "sim/effects/effect.h"
#include "sim/effects/presliding.h"

namespace slewlab::sim {

// Level: made from an EffectStart; level(moment) [Nm], asked once in a step.
template <class Level>
class BearingFriction : public Running<BearingFriction<Level>> {
 public:
  explicit BearingFriction(const EffectStart& start)
      : level_(start), asymmetry_(start.value("asymmetry")), joint_{.give = start.value("give")} {}

  void friction(const EffectMoment& moment, FrictionLevels& levels) override {
    if (joint_.give > 0.0) return;
    const double level = level_(moment);
    levels.house_positive += (1.0 + asymmetry_) * level;
    levels.house_negative += (1.0 - asymmetry_) * level;
  }

  void force(const EffectMoment& moment, PortForces& forces) override {
    if (joint_.give == 0.0) return;
    const double share = presliding_share(joint_, moment.house_angle);
    forces.house_torque -= share * ((share > 0.0 ? 1.0 + asymmetry_ : 1.0 - asymmetry_) * level_(moment));
  }

 private:
  Level level_;
  double asymmetry_;
  Presliding joint_;
};

// What such a friction is where its level is one torque, and where that rises with the speed by a coefficient [Nm s/rad] besides.
inline std::vector<common::EffectInstance> dry(double torque, const common::EffectValues& values) {
  return {{"bearing_coulomb", {torque, values["asymmetry"], values["give"]}}};
}
inline std::vector<common::EffectInstance> dry_and_viscous(double torque, double coefficient, const common::EffectValues& values) {
  return {dry(torque, values).front(), {"bearing_viscous", {coefficient, values["asymmetry"]}}};
}

inline common::EffectParameter bearing_give_parameter() {
  return give_parameter("slew angle over which the bearing takes up its friction; 0: dry friction", common::ScaleOf::axis_angle, 0.01986, 5.955e-4);
}

}  // namespace slewlab::sim
