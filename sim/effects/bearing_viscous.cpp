#include "sim/effects/bearing_viscous.h"

#include "sim/effects/asymmetry.h"

namespace slewlab::sim {

namespace {

class BearingViscous : public Running<BearingViscous> {
 public:
  explicit BearingViscous(const EffectStart& start)
      : positive_(start.values[0] * (1.0 + start.values[1])),
        negative_(start.values[0] * (1.0 - start.values[1])) {}

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
                                .meaning = "friction per speed, mean of both directions",
                                .lower = 0.0,
                                .upper = 5e7,
                                .typical = 5e6,
                                .prior_scale = 2e6,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0},
                               asymmetry_parameter()}},
      .ports = {EffectPort::force},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<BearingViscous>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
