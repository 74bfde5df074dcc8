// Large angles: the rope's true sideways pull in place of its small-angle one. With sin(beta) = (y_1 -
// y_tip) / L the tension is T = M (g cos(beta) + L beta'^2 - y_tip'' sin(beta)), so that the load feels
// besides M g sin(beta)
//   F = -share M sin(beta) (g (cos(beta) - 1) + L beta'^2 - y_tip'' sin(beta)),   the tip -F.
// The rod keeps its small angles. share 1 is the whole nonlinearity, 0 none.
// Source: textbook (pendulum with a moved support); thesis 3.3.3 takes small angles.
#include "sim/effects/effect.h"

#include <algorithm>
#include <cmath>

#include "sim/integrate/plant.h"

namespace slewlab::sim {

namespace {

class LargeAngles : public Running<LargeAngles> {
 public:
  explicit LargeAngles(const EffectStart& start)
      : mass_(start.value("share") * start.model.parameters.load.mass),
        length_(start.model.parameters.load.rope_length) {}

  void force(const EffectMoment& moment, PortForces& ports) override {
    if (mass_ == 0.0) return;
    const double sine =
        std::clamp((moment.load_displacement - moment.tip_displacement) / length_, -0.99, 0.99);
    const double cosine = std::sqrt(1.0 - sine * sine);
    const double rate = (moment.load_velocity - moment.tip_velocity) / (length_ * cosine);
    const double force =
        -mass_ * sine * (kGravity * (cosine - 1.0) + length_ * rate * rate - moment.tip_acceleration * sine);
    ports.load_force += force;
    ports.tip_force -= force;
  }

 private:
  double mass_;  // [kg] times share
  double length_;
};

}  // namespace

const EffectDescription& large_angles() {
  static const EffectDescription description{
      .about = {.name = "large_angles",
                .subsystem = common::Subsystem::load,
                .physics = "the rope's pull at large swing angles",
                .parameters = {{.name = "share",
                                .unit = common::Unit::none,
                                .meaning = "of the nonlinear part; 1 is physical",
                                .lower = 0.0,
                                .upper = 1.0,
                                .typical = 1.0,
                                .prior_scale = 1.0,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0}},
                .needs = {.load = true}},
      .ports = {EffectPort::force},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<LargeAngles>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
