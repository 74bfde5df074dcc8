#include "sim/effects/hoisting.h"

#include <algorithm>

#include "sim/integrate/plant.h"

namespace slewlab::sim {

namespace {

constexpr double kShortestRope = 2.0;  // [m]
constexpr double kRampTime = 1.0;      // [s] of the hoisting speed, chosen: a usual winch

class Hoisting : public Running<Hoisting> {
 public:
  explicit Hoisting(const EffectStart& start)
      : speed_(start.values[0]),
        start_(start.values[1]),
        duration_(start.values[2]),
        ramp_(std::min(kRampTime, 0.5 * start.values[2])),
        mass_(start.model.parameters.load.mass),
        length_(start.model.parameters.load.rope_length) {}

  void force(const EffectMoment& moment, PortForces& ports) override {
    const double since = moment.time - start_;
    if (since <= 0.0 || mass_ == 0.0) return;
    const double hoisted = speed_ * (ramped(since) - ramped(since - (duration_ - ramp_)));
    double acceleration = 0.0;
    if (since < ramp_) acceleration = speed_ / ramp_;
    if (since > duration_ - ramp_ && since < duration_) acceleration -= speed_ / ramp_;
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
  // [s] way per speed after `since` of a speed that rises linearly within ramp_ and stays.
  double ramped(double since) const {
    if (since <= 0.0) return 0.0;
    return since < ramp_ ? 0.5 * since * since / ramp_ : since - 0.5 * ramp_;
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
                                .typical = 0.5,
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
                                .absent = std::nullopt,
                                .tries = {2.0, 5.0}},
                               {.name = "duration",
                                .unit = common::Unit::second,
                                .meaning = "how long it lasts",
                                .lower = 0.5,
                                .upper = 600.0,
                                .typical = 20.0,
                                .prior_scale = 10.0,
                                .scale = common::ParameterScale::linear,
                                .absent = std::nullopt,
                                .tries = {10.0}}}},
      .ports = {EffectPort::force},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<Hoisting>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
