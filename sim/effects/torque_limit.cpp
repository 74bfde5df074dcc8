#include "sim/effects/torque_limit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace slewlab::sim {

namespace {

class TorqueLimit : public Running<TorqueLimit> {
 public:
  explicit TorqueLimit(const EffectStart& start) : limit_(start.values[0]), knee_(start.values[1] * limit_) {}

  void actuator(const EffectMoment&, GroupArray& motor_torque) override {
    for (double& torque : motor_torque) torque = limited(torque);
  }

 private:
  double limited(double torque) const {
    if (knee_ == 0.0) return std::clamp(torque, -limit_, limit_);
    const double above = std::fabs(torque) - (limit_ - knee_);
    if (above <= 0.0) return torque;
    return std::copysign(limit_ - knee_ + knee_ * std::tanh(above / knee_), torque);
  }

  double limit_;  // [Nm]
  double knee_;   // [Nm] below the limit, over which the drive yields
};

}  // namespace

const EffectDescription& torque_limit() {
  static const EffectDescription description{
      .about = {.name = "torque_limit",
                .subsystem = common::Subsystem::drive,
                .physics = "the drive delivers no more than a largest torque per motor",
                .parameters = {{.name = "limit",
                                .unit = common::Unit::newton_metre,
                                .meaning = "largest torque of one motor",
                                .lower = 20.0,
                                .upper = 2000.0,
                                .typical = 150.0,
                                .prior_scale = 0.7,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = std::numeric_limits<double>::infinity(),
                                // From 44 % to 92 % of T100 = 250 Nm (config/controllers/thesis.yaml): what a slew may meet.
                                .tries = {110.0, 130.0, 175.0, 200.0, 230.0}},
                               {.name = "knee",
                                .unit = common::Unit::none,
                                .meaning = "share of the limit over which the drive yields; 0: a hard limit",
                                .lower = 0.0,
                                .upper = 0.6,
                                .typical = 0.1,
                                .prior_scale = 0.2,
                                .scale = common::ParameterScale::linear,
                                .absent = std::nullopt,
                                .detail = true}}},
      .ports = {EffectPort::actuator},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<TorqueLimit>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
