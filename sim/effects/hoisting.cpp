#include "sim/effects/hoisting.h"

#include <algorithm>

#include "sim/integrate/plant.h"

namespace slewlab::sim {

namespace {

constexpr double kShortestRope = 2.0;  // [m]

class Hoisting : public Running<Hoisting> {
 public:
  explicit Hoisting(const EffectStart& start)
      : speed_(start.values[0]),
        start_(start.values[1]),
        duration_(start.values[2]),
        ramp_(std::min(start.values[3], 0.5 * start.values[2])),
        mass_(start.model.parameters.load.mass),
        length_(start.model.parameters.load.rope_length) {}

  void force(const EffectMoment& moment, PortForces& ports) override {
    const double since = moment.time - start_;
    if (since <= 0.0 || mass_ == 0.0) return;
    const double hoisted = speed_ * (way(since) - way(since - (duration_ - ramp_)));
    double acceleration = speed_ * (rise(since) - rise(since - (duration_ - ramp_)));
    double length = length_ - hoisted;
    if (length < kShortestRope) {
      length = kShortestRope;
      acceleration = 0.0;
    }
    const double change = mass_ * ((kGravity + acceleration) / length - kGravity / length_) *
                          (moment.load_displacement - moment.tip_displacement);
    ports.load_force -= change;
    ports.tip_force += change;
  }

 private:
  // Per hoisting speed, `since` [s] after a ramp's begin: the way [s] and the acceleration [1/s].
  double way(double since) const {
    if (since <= 0.0) return 0.0;
    if (since >= ramp_) return since - 0.5 * ramp_;
    const double share = since / ramp_;
    return ramp_ * share * share * share * (1.0 - 0.5 * share);
  }
  double rise(double since) const {
    if (since <= 0.0 || since >= ramp_) return 0.0;
    const double share = since / ramp_;
    return 6.0 * share * (1.0 - share) / ramp_;
  }

  double speed_, start_, duration_, ramp_;
  double mass_, length_;
};

}  // namespace

const EffectDescription& hoisting() {
  static const EffectDescription description{
      .about = {.name = "hoisting",
                .subsystem = common::Subsystem::load,
                .physics = "the load is hoisted during the slew",
                .parameters = {{.name = "speed",
                                .unit = common::Unit::metre_per_second,
                                .meaning = "of hoisting, positive up",
                                .lower = -1.5,
                                .upper = 1.5,
                                .typical = 0.2,
                                .prior_scale = 0.3,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0},
                               {.name = "start",
                                .unit = common::Unit::second,
                                .meaning = "when it begins",
                                .lower = 0.0,
                                .upper = 600.0,
                                .typical = 8.0,
                                .prior_scale = 10.0,
                                .scale = common::ParameterScale::linear,
                                .absent = std::nullopt},
                               {.name = "duration",
                                .unit = common::Unit::second,
                                .meaning = "how long it lasts",
                                .lower = 0.5,
                                .upper = 600.0,
                                .typical = 20.0,
                                .prior_scale = 10.0,
                                .scale = common::ParameterScale::linear,
                                .absent = std::nullopt},
                               {.name = "ramp_time",
                                .unit = common::Unit::second,
                                .meaning = "in which the speed is brought up, and down",
                                .lower = 0.1,
                                .upper = 20.0,
                                .typical = 1.5,
                                .prior_scale = 0.4,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = std::nullopt,
                                .detail = true}},
                .spell = common::Spell{.begin = 1, .duration = 2, .fade = 3}},
      .ports = {EffectPort::force},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<Hoisting>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
