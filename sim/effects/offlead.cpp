// Offlead: slewing swings the load outwards, in the plane that turns with the house, as the double pendulum that it is across the boom too.
// With x = [u; b_r] of the rope's lower end and the rod outwards, s = [y_1 - y_tip; beta_2] across, W = theta' of the house and the
// matrices of LoadOnSpring (load.h),
//   M (x'' - 2 W s' - W' s - W^2 x) + C x' + K x = M [r_tip W^2; 0],
// and outwards it answers the slewing with its larger radius and by Coriolis,
//   F = -share M (W' x + 2 W x' - W^2 s)   on [y_1; beta_2].
// With p = x' - W s, in which the slewing's acceleration, of which the boom's fastest modes are a large part, does not appear,
//   M (p' - W s' - W^2 x) + C x' + K x = M [r_tip W^2; 0],   F = -share M ((W x)' + W p).
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
      : share_(start.value("share")), radius_(sheave_radius(start.model.parameters.boom)), length_(start.model.parameters.load.rope_length),
        load_(start.model.load) {
    damping_ = 2.0 * start.model.parameters.load.damping_ratio * load_.frequency;
  }

  // On a house that turns evenly it hangs at (K - W^2 M) x = M [r_tip W^2; 0].
  void begin(const OutwardSwing& swing) override {
    const double square = swing.house_speed * swing.house_speed;
    const Eigen::Vector2d thrown = in_modes({radius_ * square, 0.0}), line = in_modes({length_, 1.0});
    for (int mode = 0; mode < 2; ++mode) {
      const double stiffness = load_.frequency(mode) * load_.frequency(mode) - square;
      out_(mode) = (stiffness > 0.0 ? thrown(mode) / stiffness : 0.0) + line(mode) * swing.angle;
      momentum_(mode) = line(mode) * swing.rate;  // x' still: the first step knows s
    }
    momentum_rate_.setZero();
    carried_ = swing.house_speed * (load_.modes * out_);
    has_past_ = false;
  }

  void force(const EffectMoment& moment, PortForces& ports) override {
    if (share_ == 0.0) return;
    const double h = moment.step, turn = moment.house_speed;
    const Eigen::Vector2d across(moment.load_displacement - moment.tip_displacement, moment.rod_angle);
    const Eigen::Vector2d across_rate(moment.load_velocity - moment.tip_velocity, moment.rod_rate);
    if (!has_past_) momentum_ -= turn * in_modes(across - 0.5 * h * across_rate);
    // In the modes of the load: the middle of the step.
    const Eigen::Vector2d rate = momentum_ + 0.5 * h * momentum_rate_ + turn * in_modes(across);
    const Eigen::Vector2d middle = out_ + 0.5 * h * rate, out = load_.modes * middle;
    momentum_rate_ = in_modes(turn * across_rate + turn * turn * (out + Eigen::Vector2d(radius_, 0.0))) - damping_.cwiseProduct(rate) -
                     load_.frequency.cwiseAbs2().cwiseProduct(middle);
    const Eigen::Vector2d momentum = momentum_ + 0.5 * h * momentum_rate_;
    out_ += h * (momentum + turn * in_modes(across));
    momentum_ += h * momentum_rate_;
    // (W x)' at the ends of this step and the one before, by what it was in the middle of each.
    const Eigen::Vector2d carried_rate = (turn * out - carried_) / (has_past_ ? h : 0.5 * h);
    const Eigen::Vector2d ahead = has_past_ ? 1.5 * carried_rate - 0.5 * carried_rate_ : carried_rate;
    carried_ = turn * out;
    carried_rate_ = carried_rate;
    has_past_ = true;
    const Eigen::Vector2d back = share_ * (load_.mass * (ahead + turn * (load_.modes * momentum)));
    ports.load_force -= back(0);
    ports.rod_moment -= back(1);
  }

 private:
  Eigen::Vector2d in_modes(const Eigen::Vector2d& motion) const { return load_.modes.transpose() * (load_.mass * motion); }

  double share_;
  double radius_, length_;  // [m]
  LoadOnSpring load_;
  Eigen::Vector2d damping_ = Eigen::Vector2d::Zero();  // [1/s] of the modes
  Eigen::Vector2d out_ = Eigen::Vector2d::Zero(), momentum_ = Eigen::Vector2d::Zero(), momentum_rate_ = Eigen::Vector2d::Zero();  // x and p in modes
  Eigen::Vector2d carried_ = Eigen::Vector2d::Zero(), carried_rate_ = Eigen::Vector2d::Zero();  // W x of the last step's middle, and (W x)'
  bool has_past_ = false;
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
                .needs = {.boom = true, .load = true},
                .swings_outwards = true},
      .ports = {EffectPort::force},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<Offlead>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
