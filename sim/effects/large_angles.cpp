// Large angles: the load as the double pendulum that it is, in place of small swings: a uniform rod of mass M and length l on a rope of length L, with
//   sin(b_1) = (y_1 - y_tip) / L,   sin(b_2) = y_2 of the rod's lateral extension over l.
// In y_1 and y_2 the lateral motion is as it was; what the small angles leave out is that the load rises and falls, by
//   z_1'' = L (sin(b_1) b_1'' + cos(b_1) b_1'^2) of the rope's end,   w = sin(b_2) b_2'' + cos(b_2) b_2'^2 over the rod's length,
// so that besides M g (y_1 - y_tip) / L and M g (l / 2) y_2 there act, by the principle of virtual work,
//   F = -share M (tan(b_1) (g + z_1'' + (l / 2) w) - g sin(b_1))                      on the load, -F on the tip,
//   Q = -share M (tan(b_2) ((l / 2) (g + z_1'') + (l^2 / 3) w) - (l / 2) g sin(b_2))   on the rod.
// b_1'' and b_2'' are those of the free double pendulum under a tip that moves with y_tip''. share 1 is the whole nonlinearity, 0 none.
//
// Part of F is a mass M sin(b_1)^2 at the tip, which on a light boom outweighs the faster modes; on the acceleration as it was read it would
// feed them. So y_tip'' is that of a point led along by the tip, z'' = w^2 (y - z) + 2 zeta w (y' - z'), which knows no more of them than a spring
// and a damper do: w h = 0.2, or less where the mass asks for it, so that the damper's step stays below a half.
// Assumes a rope that is always taut; damping and other forces on the load do not change b_1'' and b_2''.
// Source: textbook (double pendulum with a moved support); thesis 3.3.3 takes small angles.
#include "sim/effects/effect.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/integrate/plant.h"

namespace slewlab::sim {

namespace {

constexpr double kLargestSine = 0.99;    // of a swing: beyond, the rope is not taut
constexpr double kRadiansPerStep = 0.2;  // w h: 32 Hz at 1 ms, far above the modes that swing with the load; chosen
constexpr double kLongestDamping = 0.5;  // [-] of the tip's velocity that the damper takes in one step, at most; chosen
constexpr double kDampingRatio = 0.7;    // zeta: the flattest answer below w

class LargeAngles : public Running<LargeAngles> {
 public:
  explicit LargeAngles(const EffectStart& start)
      : mass_(start.value("share") * start.model.parameters.load.mass),
        length_(start.model.parameters.load.rope_length),
        half_rod_(0.5 * start.model.parameters.load.rod_length),
        tip_mobility_(std::inner_product(start.model.tip.begin(), start.model.tip.end(), start.model.tip.begin(), 0.0)) {}

  void force(const EffectMoment& moment, PortForces& ports) override {
    if (mass_ == 0.0) return;
    const Swing rope = swing((moment.load_displacement - moment.tip_displacement) / length_, (moment.load_velocity - moment.tip_velocity) / length_);
    const Swing rod = swing(moment.rod_angle, moment.rod_rate);
    const auto [rope_turn, rod_turn] = turned(rope, rod, led_along(moment, mass_ * rope.sine * rope.sine));
    const double rise = length_ * (rope.sine * rope_turn + rope.cosine * rope.rate * rope.rate);      // z_1''
    const double tilt = rod.sine * rod_turn + rod.cosine * rod.rate * rod.rate;                       // w
    const double rope_pull = rope.sine / rope.cosine * (kGravity + rise + half_rod_ * tilt) - kGravity * rope.sine;
    const double rod_pull =
        rod.sine / rod.cosine * (half_rod_ * (kGravity + rise) + 4.0 / 3.0 * half_rod_ * half_rod_ * tilt) - half_rod_ * kGravity * rod.sine;
    ports.load_force -= mass_ * rope_pull;
    ports.tip_force += mass_ * rope_pull;
    ports.rod_moment -= mass_ * rod_pull;
  }

 private:
  struct Swing {
    double sine, cosine;
    double rate;  // [rad/s]
  };

  // From the lateral extension over the length, and its change.
  static Swing swing(double extension, double change) {
    const double sine = std::clamp(extension, -kLargestSine, kLargestSine);
    const double cosine = std::sqrt(1.0 - sine * sine);
    return {sine, cosine, change / cosine};
  }

  struct Turns {
    double rope, rod;  // [rad/s^2] b_1'', b_2''
  };

  // Of the free double pendulum under its moved tip; a point load has no rod.
  Turns turned(const Swing& rope, const Swing& rod, double tip_acceleration) const {
    const double along = rope.cosine * rod.cosine + rope.sine * rod.sine, across = rope.sine * rod.cosine - rope.cosine * rod.sine;
    const double rope_alone = -(half_rod_ * across * rod.rate * rod.rate + kGravity * rope.sine + rope.cosine * tip_acceleration) / length_;
    if (half_rod_ == 0.0) return {rope_alone, 0.0};
    const double rod_alone = length_ * across * rope.rate * rope.rate - kGravity * rod.sine - rod.cosine * tip_acceleration;
    const double rod_turn = (rod_alone - length_ * along * rope_alone) / (half_rod_ * (4.0 / 3.0 - along * along));
    return {rope_alone - half_rod_ / length_ * along * rod_turn, rod_turn};
  }

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
  double length_, half_rod_;  // [m]
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
