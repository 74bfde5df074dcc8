// Command delay: what the controller says arrives at the drives a fixed time later, torque, brake and
// enable. Where it arrives inside a step, the step gets the mean of the torques and the older enable.
// Source: textbook (bus cycle between PLC and drive). Not in the thesis.
#include "sim/effects/effect.h"

#include "sim/effects/delay_line.h"
#include "sim/integrate/plant.h"

namespace slewlab::sim {

namespace {

class CommandDelay : public Running<CommandDelay> {
 public:
  explicit CommandDelay(const EffectStart& start)
      : delay_(start.value("delay") / start.model.step), line_(delay_), group_count_(static_cast<std::size_t>(start.model.group_count)) {}

  void message(double, DriveCommand& command) override {
    line_.push(command);
    const auto past = line_.at(delay_);
    DriveCommand arrived = past.share > 0.0 ? past.older : past.newer;
    for (std::size_t i = 0; i < group_count_; ++i) {
      arrived.motor_torque[i] = blend(past.older.motor_torque[i], past.newer.motor_torque[i], past.share);
      arrived.brake_torque[i] = blend(past.older.brake_torque[i], past.newer.brake_torque[i], past.share);
    }
    command = arrived;
  }

 private:
  double delay_;  // [steps]
  DelayLine<DriveCommand> line_;
  std::size_t group_count_;
};

}  // namespace

const EffectDescription& command_delay() {
  static const EffectDescription description{
      .about = {.name = "command_delay",
                .subsystem = common::Subsystem::wire,
                .physics = "commands arrive late at the drives",
                .parameters = {{.name = "delay",
                                .unit = common::Unit::second,
                                .per = common::ScaleOf::time,
                                .meaning = "from controller to drives",
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
      .ports = {EffectPort::message},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<CommandDelay>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
