#include "sim/effects/command_delay.h"

#include "sim/effects/delay_line.h"
#include "sim/integrate/plant.h"

namespace slewlab::sim {

namespace {

class CommandDelay : public Running<CommandDelay> {
 public:
  explicit CommandDelay(const EffectStart& start)
      : delay_(start.values[0] / start.model.step), line_(delay_) {}

  void message(double, DriveCommand& command) override {
    line_.push(command);
    const auto past = line_.at(delay_);
    DriveCommand arrived = past.share > 0.0 ? past.older : past.newer;
    for (std::size_t i = 0; i < command.motor_torque.size(); ++i) {
      arrived.motor_torque[i] = blend(past.older.motor_torque[i], past.newer.motor_torque[i], past.share);
      arrived.brake_torque[i] = blend(past.older.brake_torque[i], past.newer.brake_torque[i], past.share);
    }
    command = arrived;
  }

 private:
  double delay_;  // [steps]
  DelayLine<DriveCommand> line_;
};

}  // namespace

const EffectDescription& command_delay() {
  static const EffectDescription description{
      .about = {.name = "command_delay",
                .subsystem = common::Subsystem::wire,
                .physics = "commands arrive late at the drives",
                .parameters = {{.name = "delay",
                                .unit = common::Unit::second,
                                .meaning = "from controller to drives",
                                .lower = 0.0,
                                .upper = 0.2,
                                .typical = 0.03,
                                .prior_scale = 0.02,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0}}},
      .ports = {EffectPort::message},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<CommandDelay>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
