// Torque limit: the drive delivers no more than T_max, whatever it is told,
//   T = clamp(T_command, -T_max, T_max).
// With `knee` w > 0 it yields before: |T| follows the command up to (1 - w) T_max and goes on, with the same slope, as
//   (1 - w) T_max + w T_max tanh((|T_command| - (1 - w) T_max) / (w T_max)).
// Source: every drive has a current limit; the thesis assumes that it is never met (2.4).
#include "sim/effects/effect.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "sim/integrate/plant.h"

namespace slewlab::sim {

namespace {

class TorqueLimit : public Running<TorqueLimit> {
 public:
  explicit TorqueLimit(const EffectStart& start)
      : limit_(start.value("limit")), knee_(start.value("knee") * limit_), group_count_(static_cast<std::size_t>(start.model.group_count)) {}

  void actuator(const EffectMoment&, GroupArray& motor_torque) override {
    for (std::size_t i = 0; i < group_count_; ++i) motor_torque[i] = limited(motor_torque[i]);
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
  std::size_t group_count_;
};

}  // namespace

const EffectDescription& torque_limit() {
  static const EffectDescription description{
      .about = {.name = "torque_limit",
                .subsystem = common::Subsystem::drive,
                .physics = "the drive delivers no more than a largest torque per motor",
                .parameters = {{.name = "limit",
                                .unit = common::Unit::newton_metre,
                                .per = common::ScaleOf::drive_torque,  // below what the drive is known to limit, nothing else would be seen
                                .meaning = "largest torque of one motor",
                                .lower = 0.08,
                                .upper = 8.0,
                                .typical = 0.6,
                                .prior_scale = 0.7,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = std::numeric_limits<double>::infinity(),
                                // From 44 % to 92 % of the rated torque: what a slew may ask for.
                                .tries = {0.44, 0.52, 0.7, 0.8, 0.92}},
                               {.name = "knee",
                                .unit = common::Unit::none,
                                .meaning = "share of the limit over which the drive yields; 0: a hard limit",
                                .lower = 0.0,
                                .upper = 0.6,
                                .typical = 0.1,
                                .prior_scale = 0.2,
                                .scale = common::ParameterScale::linear,
                                .absent = std::nullopt,
                                .detail = true}},
                .before_torque = true},
      .ports = {EffectPort::actuator},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<TorqueLimit>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
