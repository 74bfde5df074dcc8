// Dead time of the drive: T(t) = T_command(t - delay).
// A command is held between steps; where the delay ends inside a step, the step gets the mean.
// Source: textbook; sampling and modulation of a VFD. The thesis neglects the VFD (2.3).
#include "sim/effects/effect.h"

#include "sim/effects/delay_line.h"
#include "sim/integrate/plant.h"

namespace slewlab::sim {

namespace {

class DeadTime : public Running<DeadTime> {
 public:
  explicit DeadTime(const EffectStart& start)
      : delay_(start.value("delay") / start.model.step), line_(delay_), group_count_(static_cast<std::size_t>(start.model.group_count)) {}

  void actuator(const EffectMoment&, GroupArray& motor_torque) override {
    line_.push(motor_torque);
    const auto past = line_.at(delay_);
    for (std::size_t i = 0; i < group_count_; ++i) {
      motor_torque[i] = blend(past.older[i], past.newer[i], past.share);
    }
  }

 private:
  double delay_;  // [steps]
  DelayLine<GroupArray> line_;
  std::size_t group_count_;
};

}  // namespace

const EffectDescription& dead_time() {
  static const EffectDescription description{
      .about = {.name = "dead_time",
                .subsystem = common::Subsystem::drive,
                .physics = "the motor torque follows its command after a fixed time",
                .parameters = {{.name = "delay",
                                .unit = common::Unit::second,
                                .per = common::ScaleOf::time,
                                .meaning = "time from command to torque",
                                .lower = 0.0,
                                .upper = 0.1986,
                                .typical = 0.02978,
                                .prior_scale = 0.01985,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0}},
                .family = common::Family::delay,
                .acts_late = true,
                .pure_delay = common::PureDelay::command,
                .before_torque = true,
                .linear = true},
      .ports = {EffectPort::actuator},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<DeadTime>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
