// Viscous friction of the slew bearing:
//   T = -d (1 + a) omega_house for positive speed, -d (1 - a) omega_house for negative.
// Source: textbook (grease film). Not in the thesis.
#include "sim/effects/effect.h"

#include "sim/effects/asymmetry.h"

namespace slewlab::sim {

namespace {

class BearingViscous : public Running<BearingViscous> {
 public:
  explicit BearingViscous(const EffectStart& start)
      : positive_(start.value("coefficient") * (1.0 + start.value("asymmetry"))),
        negative_(start.value("coefficient") * (1.0 - start.value("asymmetry"))) {}

  void force(const EffectMoment& moment, PortForces& ports) override {
    ports.house_torque -= (moment.house_speed > 0.0 ? positive_ : negative_) * moment.house_speed;
  }

 private:
  double positive_;
  double negative_;
};

}  // namespace

const EffectDescription& bearing_viscous() {
  static const EffectDescription description{
      .about = {.name = "bearing_viscous",
                .subsystem = common::Subsystem::house,
                .physics = "friction of the slew bearing that grows with speed",
                .parameters = {{.name = "coefficient",
                                .unit = common::Unit::newton_metre_second_per_radian,
                                .per = common::ScaleOf::axis_damping,
                                .meaning = "friction per speed, mean of both directions",
                                .lower = 0.0,
                                .upper = 1.0,  // all of the rated torque is lost in it at top speed
                                .typical = 0.06093,
                                .prior_scale = 0.02437,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0},
                               asymmetry_parameter()},
                .family = common::Family::friction,
                .linear = true},
      .ports = {EffectPort::force},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<BearingViscous>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
