// Hoisting while slewing: the rope's length is L(t) = L_0 - s(t), s rising at the hoisting speed v from
// `start` for `duration`. The speed is brought up and down within the ramp time t_r (or half the duration). With x = t / t_r and the
// share p = rounding / 2 of it the acceleration is
//   v / (t_r (1 - 2 p / 3)) a(x),   a = 1 - (1 - x / p)^2 where x < p,   1 between p and 1 - p,   a(x) = a(1 - x):
// a drive that ramps linearly (rounding 0) begins with a step of it, which strikes the boom; with 1 the speed is v (3 x^2 - 2 x^3). In the absolute
// displacement y_1 of the load the small-angle equation is M y_1'' = -T (y_1 - y_tip) / L(t) with the tension
// T = M (g + s''): the law of a moving rope (sim/model/load.h), which a scenario's hoisting obeys too.
// L is kept at a thirtieth of L_0 or more. Negative speed lowers.
// Source: textbook; thesis 5 names hoisting as future work.
#include "sim/effects/effect.h"

#include <algorithm>

#include "sim/integrate/plant.h"
#include "sim/model/load.h"

namespace slewlab::sim {

namespace {

constexpr double kShortestRope = 1.0 / 30.0;  // of its length

// A ramp from 0 to 1 whose acceleration comes up, and goes, within `share` of its time, at most a half.
struct RoundedRamp {
  double time = 0.0, share = 0.0;

  double top() const { return 1.0 / (1.0 - 2.0 / 3.0 * share); }
  // [s] `since` its begin.
  double way(double since) const {
    if (since <= 0.0) return 0.0;
    if (since >= time) return since - 0.5 * time;
    const double x = since / time;
    return x <= 0.5 ? time * way_of_half(x) : time * (x - 0.5 + way_of_half(1.0 - x));
  }
  double acceleration(double since) const {  // [1/s]
    if (since <= 0.0 || since >= time) return 0.0;
    const double x = std::min(since, time - since) / time;
    if (x >= share) return top() / time;
    const double missing = 1.0 - x / share;
    return top() / time * (1.0 - missing * missing);
  }

 private:
  // The first half, as a share of the time.
  double way_of_half(double x) const {
    if (x < share) return top() * x * x * x / share * (1.0 / 3.0 - x / (12.0 * share));
    const double beyond = x - share;
    return top() * (0.25 * share * share + 2.0 / 3.0 * share * beyond + 0.5 * beyond * beyond);
  }
};

class Hoisting : public Running<Hoisting> {
 public:
  explicit Hoisting(const EffectStart& start)
      : speed_(start.value("speed")),
        start_(start.value("start")),
        duration_(start.value("duration")),
        ramp_{std::min(start.value("ramp_time"), 0.5 * start.value("duration")), 0.5 * start.value("rounding")},
        load_(start.model.parameters.load) {}

  void force(const EffectMoment& moment, PortForces& ports) override {
    const double since = moment.time - start_;
    if (since <= 0.0 || load_.mass == 0.0) return;
    const double since_end = since - (duration_ - ramp_.time);
    const double hoisted = speed_ * (ramp_.way(since) - ramp_.way(since_end));
    double acceleration = speed_ * (ramp_.acceleration(since) - ramp_.acceleration(since_end));
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
  double speed_, start_, duration_;
  RoundedRamp ramp_;
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
                                .lower = -1.9158,
                                .upper = 1.9158,
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
                                .detail = true},
                               {.name = "rounding",
                                .meaning = "share of the ramp in which the acceleration changes; 0: the speed rises linearly",
                                .lower = 0.0,
                                .upper = 1.0,
                                .typical = 0.5,
                                .prior_scale = 0.5,
                                .scale = common::ParameterScale::linear,
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
