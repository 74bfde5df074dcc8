// Large angles: the rope's true sideways pull in place of its small-angle one. With sin(beta) = (y_1 -
// y_tip) / L the tension is T = M (g cos(beta) + L beta'^2 - y_tip'' sin(beta)), so that the load feels
// besides M g sin(beta)
//   F = -share M sin(beta) (g (cos(beta) - 1) + L beta'^2 - y_tip'' sin(beta)),   the tip -F.
// The rod keeps its small angles. share 1 is the whole nonlinearity, 0 none.
//
// Part of it is a mass M sin(beta)^2 at the tip, which on a light boom outweighs the faster modes; on the acceleration as it was read it would
// feed them. So y_tip'' is that of a point led along by the tip, z'' = w^2 (y - z) + 2 zeta w (y' - z'), which knows no more of them than a spring
// and a damper do: w h = 0.2, or less where the mass asks for it, so that the damper's step stays below a half.
// Source: textbook (pendulum with a moved support); thesis 3.3.3 takes small angles.
#include "sim/effects/effect.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/integrate/plant.h"

namespace slewlab::sim {

namespace {

constexpr double kRadiansPerStep = 0.2;  // w h: 32 Hz at 1 ms, far above the modes that swing with the load; chosen
constexpr double kLongestDamping = 0.5;  // [-] of the tip's velocity that the damper takes in one step, at most; chosen
constexpr double kDampingRatio = 0.7;    // zeta: the flattest answer below w

class LargeAngles : public Running<LargeAngles> {
 public:
  explicit LargeAngles(const EffectStart& start)
      : mass_(start.value("share") * start.model.parameters.load.mass),
        length_(start.model.parameters.load.rope_length),
        tip_mobility_(std::inner_product(start.model.tip.begin(), start.model.tip.end(), start.model.tip.begin(), 0.0)) {}

  void force(const EffectMoment& moment, PortForces& ports) override {
    if (mass_ == 0.0) return;
    const double sine =
        std::clamp((moment.load_displacement - moment.tip_displacement) / length_, -0.99, 0.99);
    const double cosine = std::sqrt(1.0 - sine * sine);
    const double rate = (moment.load_velocity - moment.tip_velocity) / (length_ * cosine);
    const double acceleration = led_along(moment, mass_ * sine * sine);
    const double force = -mass_ * sine * (kGravity * (cosine - 1.0) + length_ * rate * rate - acceleration * sine);
    ports.load_force += force;
    ports.tip_force -= force;
  }

 private:
  // z'' over the step; `mass` [kg] is what hangs on it.
  double led_along(const EffectMoment& moment, double mass) {
    if (moment.time <= 0.0) return 0.0;  // before the run the crane is at rest
    if (!is_led_) {
      is_led_ = true;
      place_ = moment.tip_displacement;
      speed_ = moment.tip_velocity;
    }
    const double h = moment.step;
    const double per_step = std::min(kRadiansPerStep, kLongestDamping / (2.0 * kDampingRatio * std::max(1e-300, mass * tip_mobility_)));
    const double w = per_step / h;
    const double acceleration = w * w * (moment.tip_displacement - place_) + 2.0 * kDampingRatio * w * (moment.tip_velocity - speed_);
    speed_ += h * acceleration;
    place_ += h * speed_;
    return acceleration;
  }

  double mass_;  // [kg] times share
  double length_;
  double tip_mobility_;  // [1/kg] acceleration of the tip per force on it, before anything has moved
  double place_ = 0.0, speed_ = 0.0;  // z [m], z' [m/s]
  bool is_led_ = false;
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
                .needs = {.load = true},
                .of_every_machine = true},
      .ports = {EffectPort::force},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<LargeAngles>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
