// Command loss: messages are lost in bursts, and the drives hold the last one that arrived. Where no burst is on, one
// begins at each message with the probability
//   q = p / (burst (1 - p) + p)
// and takes `burst` messages in a row (rounded to a whole number); another may begin right behind it. So the share that is
// lost is p for every burst, and the stretches that are lost have the mean length burst + p / (1 - p); a burst of 1 is
// independent loss, q = p. A message is known by its sequence; before the first arrives there is no torque.
// Source: textbook (lossy bus; renewals for share and length). Not in the thesis.
#include "sim/effects/effect.h"

#include <cmath>

#include "sim/effects/random_number.h"

namespace slewlab::sim {

namespace {

class CommandLoss : public Running<CommandLoss> {
 public:
  explicit CommandLoss(const EffectStart& start)
      : burst_(static_cast<int>(std::lround(start.value("burst")))),
        begins_(start.value("probability") / (burst_ * (1.0 - start.value("probability")) + start.value("probability"))),
        seed_(start.seed) {}

  void message(double, DriveCommand& command) override {
    if (!any_ || command.sequence != newest_) {
      any_ = true;
      newest_ = command.sequence;
      if (left_ > 0) --left_;
      if (left_ == 0 && uniform_number(seed_, static_cast<std::uint64_t>(command.sequence)) < begins_) left_ = burst_;
    }
    if (left_ > 0) {
      command = held_;
    } else {
      held_ = command;
    }
  }

 private:
  int burst_;      // [messages]
  double begins_;  // probability that a burst begins where none is on
  std::uint64_t seed_;
  std::int64_t newest_ = 0;
  bool any_ = false;
  int left_ = 0;  // messages of the burst that are still to be lost, this one included
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
                                .absent = 0.0},
                               {.name = "burst",
                                .unit = common::Unit::none,
                                .meaning = "messages that are lost in a row",
                                .lower = 1.0,
                                .upper = 1000.0,
                                .typical = 1.0,
                                .prior_scale = 2.0,
                                .scale = common::ParameterScale::logarithmic,
                                .absent = std::nullopt,
                                .tries = {5.0, 20.0}}},
                .family = common::Family::delay,
                .stochastic = common::Stochastic{.power_exponent = 1.0},
                .acts_late = true,
                .before_torque = true},
      .ports = {EffectPort::message},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<CommandLoss>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
