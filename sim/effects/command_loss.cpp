#include "sim/effects/command_loss.h"

#include "sim/effects/random_number.h"

namespace slewlab::sim {

namespace {

class CommandLoss : public Running<CommandLoss> {
 public:
  explicit CommandLoss(const EffectStart& start) : probability_(start.values[0]), seed_(start.seed) {}

  void message(double, DriveCommand& command) override {
    if (!any_ || command.sequence != newest_) {
      any_ = true;
      newest_ = command.sequence;
      lost_ = uniform_number(seed_, static_cast<std::uint64_t>(command.sequence)) < probability_;
    }
    if (lost_) {
      command = held_;
    } else {
      held_ = command;
    }
  }

 private:
  double probability_;
  std::uint64_t seed_;
  std::int64_t newest_ = 0;
  bool any_ = false;
  bool lost_ = false;
  DriveCommand held_;
};

}  // namespace

const EffectDescription& command_loss() {
  static const EffectDescription description{
      .about = {.name = "command_loss",
                .subsystem = common::Subsystem::wire,
                .physics = "commands get lost on the way to the drives",
                .parameters = {{.name = "probability",
                                .unit = common::Unit::none,
                                .meaning = "of losing a message",
                                .lower = 0.0,
                                .upper = 0.99,
                                .typical = 0.3,
                                .prior_scale = 0.1,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0}}},
      .ports = {EffectPort::message},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<CommandLoss>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
