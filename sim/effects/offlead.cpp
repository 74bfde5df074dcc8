// Offlead by centrifugal force: slewing swings the load outwards by u,
//   u'' + 2 zeta w u' + w^2 u = r_tip omega^2 + u omega^2,   w^2 = g / L, omega = y_1' / r_tip,
// and the load, farther out, resists the slewing with its larger radius and by Coriolis,
//   F = -share M (u omega' + 2 u' omega)   on the load's lateral motion, omega' from the rope's pull.
// Source: textbook (motion in a turning frame); thesis 2.9 neglects the offlead.
#include "sim/effects/effect.h"

#include <cmath>

#include "sim/integrate/plant.h"
#include "sim/model/boom.h"

namespace slewlab::sim {

namespace {

class Offlead : public Running<Offlead> {
 public:
  explicit Offlead(const EffectStart& start)
      : mass_(start.value("share") * start.model.parameters.load.mass),
        radius_(tip_radius(start.model.parameters.boom)) {
    const LoadParameters& load = start.model.parameters.load;
    if (mass_ == 0.0) return;
    square_ = kGravity / load.rope_length;
    damping_ = 2.0 * load.damping_ratio * std::sqrt(square_);
  }

  void force(const EffectMoment& moment, PortForces& ports) override {
    if (mass_ == 0.0) return;
    const double h = moment.step;
    const double omega = moment.load_velocity / radius_;
    const double slewing_acceleration =
        -square_ * (moment.load_displacement - moment.tip_displacement) / radius_;
    const double out = out_ + 0.5 * h * speed_;
    const double held_speed = speed_ + 0.5 * h * acceleration_;
    acceleration_ = (radius_ + out) * omega * omega - square_ * out - damping_ * held_speed;
    out_ += h * (speed_ + 0.5 * h * acceleration_);
    const double speed = speed_ + 0.5 * h * acceleration_;
    speed_ += h * acceleration_;
    ports.load_force -= mass_ * (out * slewing_acceleration + 2.0 * speed * omega);
  }

 private:
  double mass_;  // [kg] times share
  double radius_;
  double square_ = 0.0;   // [1/s^2]
  double damping_ = 0.0;  // [1/s]
  double out_ = 0.0, speed_ = 0.0, acceleration_ = 0.0;
};

}  // namespace

const EffectDescription& offlead() {
  static const EffectDescription description{
      .about = {.name = "offlead",
                .subsystem = common::Subsystem::load,
                .physics = "slewing swings the load outwards, and that acts back",
                .parameters = {{.name = "share",
                                .unit = common::Unit::none,
                                .meaning = "of the reaction; 1 is physical",
                                .lower = 0.0,
                                .upper = 1.0,
                                .typical = 1.0,
                                .prior_scale = 1.0,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0}},
                .needs = {.boom = true, .load = true}},
      .ports = {EffectPort::force},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<Offlead>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
