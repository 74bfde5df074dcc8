// Torque lag of the VFD: the motor's torque follows the command with a delay and a first-order lag behind it that share
// the time T_v,
//   tau dT/dt = T_command(t - T_d) - T,   T_d = delay_share T_v,   tau = (1 - delay_share) T_v,
// so that a ramp comes T_v late whatever the share. Several lags in a row lie between a share of 0 (one lag) and more
// delay. The delay takes the command from the two past steps around it, linearly. The lag is exact for a command held over
// the step: what acts is the mean over the step, with T_0 at its start
//   T_command + (T_0 - T_command) (tau / h) (1 - exp(-h / tau)).
// Source: thesis 2.3 (a proper VFD has about 10 ms and is left out there).
#include "sim/effects/effect.h"

#include <cmath>

#include "sim/effects/delay_line.h"
#include "sim/integrate/plant.h"

namespace slewlab::sim {

namespace {

class TorqueLag : public Running<TorqueLag> {
 public:
  explicit TorqueLag(const EffectStart& start)
      : time_constant_(start.value("time_constant") * (1.0 - start.value("delay_share"))),
        delay_(start.value("time_constant") * start.value("delay_share") / start.model.step),
        line_(delay_),
        group_count_(static_cast<std::size_t>(start.model.group_count)) {
    if (time_constant_ == 0.0) return;
    const double decay = -std::expm1(-start.model.step / time_constant_);  // 1 - exp(-h / tau)
    kept_at_end_ = 1.0 - decay;
    kept_in_mean_ = time_constant_ / start.model.step * decay;
  }

  void actuator(const EffectMoment&, GroupArray& motor_torque) override {
    if (delay_ > 0.0) {
      line_.push({motor_torque});
      const auto past = line_.at(delay_);
      for (std::size_t i = 0; i < group_count_; ++i) {
        motor_torque[i] = blend(past.older.torque[i], past.newer.torque[i], past.share);
      }
    }
    if (time_constant_ == 0.0) return;
    for (std::size_t i = 0; i < group_count_; ++i) {
      const double command = motor_torque[i];
      const double lead = torque_[i] - command;
      motor_torque[i] = command + lead * kept_in_mean_;
      torque_[i] = command + lead * kept_at_end_;
    }
  }

 private:
  struct Sample {
    GroupArray torque{};
  };
  double time_constant_;  // [s] of the lag
  double delay_;          // [steps] before it
  DelayLine<Sample> line_;
  std::size_t group_count_;
  double kept_at_end_ = 0.0;
  double kept_in_mean_ = 0.0;
  GroupArray torque_{};  // [Nm] at the step's start
};

}  // namespace

const EffectDescription& torque_lag() {
  static const EffectDescription description{
      .about = {.name = "torque_lag",
                .subsystem = common::Subsystem::drive,
                .physics = "the motor torque follows its command with a lag",
                .parameters = {{.name = "time_constant",
                                .unit = common::Unit::second,
                                .per = common::ScaleOf::time,
                                .meaning = "of lag and delay together",
                                .lower = 0.0,
                                .upper = 0.4963,
                                .typical = 0.04963,
                                .prior_scale = 0.02978,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0},
                               {.name = "delay_share",
                                .unit = common::Unit::none,
                                .meaning = "share of the time that is delay before a first-order lag",
                                .lower = 0.0,
                                .upper = 0.5,
                                .typical = 0.0,
                                .prior_scale = 0.3,
                                .scale = common::ParameterScale::linear,
                                .absent = std::nullopt,
                                .detail = true}},
                .family = common::Family::delay,
                .acts_late = true,
                .before_torque = true,
                .linear = true},
      .ports = {EffectPort::actuator},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<TorqueLag>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
