// Hoisting while slewing: the rope's length is L(t) = L_0 - s(t), s rising at the hoisting speed from
// `start` for `duration`. The speed is brought up and down within the ramp time t_r (or half the duration) as
//   v (3 (t / t_r)^2 - 2 (t / t_r)^3):
// a winch's drive has no steps of acceleration, and here they would strike the boom. In the absolute
// displacement y_1 of the load the small-angle equation is M y_1'' = -T (y_1 - y_tip) / L(t) with the tension
// T = M (g + s''): the law of a moving rope (sim/model/load.h), which a scenario's hoisting obeys too.
// L is kept at 2 m or more. Negative speed lowers.
// Source: textbook; thesis 5 names hoisting as future work.
#include "sim/effects/effect.h"

#include <algorithm>

#include "sim/integrate/plant.h"
#include "sim/model/load.h"
#include "sim/model/motion.h"

namespace slewlab::sim {

namespace {

constexpr double kShortestRope = 1.0 / 30.0;  // of its length

class Hoisting : public Running<Hoisting> {
 public:
  explicit Hoisting(const EffectStart& start)
      : speed_(start.value("speed")),
        start_(start.value("start")),
        duration_(start.value("duration")),
        ramp_(std::min(start.value("ramp_time"), 0.5 * start.value("duration"))),
        load_(start.model.parameters.load) {}

  void force(const EffectMoment& moment, PortForces& ports) override {
    const double since = moment.time - start_;
    if (since <= 0.0 || load_.mass == 0.0) return;
    const double hoisted = speed_ * (ramp_way(since, ramp_) - ramp_way(since - (duration_ - ramp_), ramp_));
    double acceleration = speed_ * (ramp_rise(since, ramp_) - ramp_rise(since - (duration_ - ramp_), ramp_));
    double length = load_.rope_length - hoisted;
    if (length < kShortestRope * load_.rope_length) {
      length = kShortestRope * load_.rope_length;
      acceleration = 0.0;
    }
    const RopeForces rope =
        moving_rope(load_, length, acceleration, moment.load_displacement - moment.tip_displacement, moment.rod_angle);
    ports.load_force += rope.load_force;
    ports.tip_force -= rope.load_force;
    ports.rod_moment += rope.rod_moment;
  }

 private:
  double speed_, start_, duration_, ramp_;
  LoadParameters load_;
};

}  // namespace

const EffectDescription& hoisting() {
  static const EffectDescription description{
      .about = {.name = "hoisting",
                .subsystem = common::Subsystem::load,
                .physics = "the load is hoisted during the slew",
                .parameters = {{.name = "speed",
                                .unit = common::Unit::metre_per_second,
                                .per = common::ScaleOf::velocity,
                                .meaning = "of hoisting, positive up",
                                .lower = -0.9579,
                                .upper = 0.9579,
                                .typical = 0.1277,
                                .prior_scale = 0.1916,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0},
                               {.name = "start",
                                .unit = common::Unit::second,
                                .per = common::ScaleOf::time,
                                .meaning = "when it begins",
                                .lower = 0.0,
                                .upper = 595.6,
                                .typical = 7.941,
                                .prior_scale = 9.926,
                                .scale = common::ParameterScale::linear,
                                .absent = std::nullopt},
                               {.name = "duration",
                                .unit = common::Unit::second,
                                .per = common::ScaleOf::time,
                                .meaning = "how long it lasts",
                                .lower = 0.4962,
                                .upper = 595.6,
                                .typical = 19.85,
                                .prior_scale = 9.926,
                                .scale = common::ParameterScale::linear,
                                .absent = std::nullopt},
                               {.name = "ramp_time",
                                .unit = common::Unit::second,
                                .per = common::ScaleOf::time,
                                .meaning = "in which the speed is brought up, and down",
                                .lower = 0.09925,
                                .upper = 19.86,
                                .typical = 1.489,
                                .prior_scale = 0.4,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = std::nullopt,
                                .detail = true}},
                .spell = common::Spell{.begin = "start", .duration = "duration", .fade = "ramp_time"},
                .needs = {.boom = true, .load = true}},
      .ports = {EffectPort::force},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<Hoisting>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
