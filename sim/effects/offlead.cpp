// Offlead: slewing swings the load outwards, in the plane that turns with the house, as the double pendulum that it is across the boom too.
// With x = [u; b_r] of the rope's lower end and the rod outwards, s = [y_1 - y_tip; beta_2] across, W = theta' of the house and the
// matrices of LoadOnSpring (load.h),
//   M (x'' - 2 W s' - W' s - W^2 x) + C x' + K x = M [r_tip W^2; 0],
// and outwards it answers the slewing with its larger radius and by Coriolis,
//   F = -share M (W' x + 2 W x' - W^2 s)   on [y_1; beta_2].
// In both directions these are the equations of small swings seen from outside, M q'' + K (q - [r_tip e^(i theta); 0]) = 0 with q complex,
// for any u / r_tip; the boom's bending does not turn the plane.
// Source: textbook (motion in a turning frame); thesis 2.9 neglects the offlead.
#include "sim/effects/effect.h"

#include <Eigen/Core>

#include "sim/integrate/plant.h"
#include "sim/model/boom.h"

namespace slewlab::sim {

namespace {

class Offlead : public Running<Offlead> {
 public:
  explicit Offlead(const EffectStart& start)
      : share_(start.value("share")), radius_(sheave_radius(start.model.parameters.boom)), load_(start.model.load) {
    damping_ = 2.0 * start.model.parameters.load.damping_ratio * load_.frequency;
  }

  void force(const EffectMoment& moment, PortForces& ports) override {
    if (share_ == 0.0) return;
    const double h = moment.step, turn = moment.house_speed, turn_rate = moment.house_acceleration;
    const Eigen::Vector2d across(moment.load_displacement - moment.tip_displacement, moment.rod_angle);
    const Eigen::Vector2d across_rate(moment.load_velocity - moment.tip_velocity, moment.rod_rate);
    // In the modes of the load, the middle of the step from what was half a step before.
    const Eigen::Vector2d middle_rate = rate_ + 0.5 * h * acceleration_;
    const Eigen::Vector2d out = load_.modes * (out_ + 0.5 * h * rate_);
    Eigen::Vector2d thrown = 2.0 * turn * across_rate + turn_rate * across + turn * turn * out;
    thrown(0) += radius_ * turn * turn;
    acceleration_ = load_.modes.transpose() * (load_.mass * thrown) - damping_.cwiseProduct(middle_rate) -
                    load_.frequency.cwiseAbs2().cwiseProduct(out_ + 0.5 * h * rate_);
    out_ += h * (rate_ + 0.5 * h * acceleration_);
    const Eigen::Vector2d out_rate = load_.modes * (rate_ + 0.5 * h * acceleration_);
    rate_ += h * acceleration_;
    const Eigen::Vector2d back = share_ * (load_.mass * (turn_rate * out + 2.0 * turn * out_rate - turn * turn * across));
    ports.load_force -= back(0);
    ports.rod_moment -= back(1);
  }

 private:
  double share_;
  double radius_;  // [m]
  LoadOnSpring load_;
  Eigen::Vector2d damping_ = Eigen::Vector2d::Zero();  // [1/s] of the modes
  Eigen::Vector2d out_ = Eigen::Vector2d::Zero(), rate_ = Eigen::Vector2d::Zero(), acceleration_ = Eigen::Vector2d::Zero();
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
