// Command jitter: every message takes a time of its own to arrive, evenly drawn from 0 ... spread, at
// whole steps; a message never overtakes an older one. A message is known by its sequence.
//   arrival_k = max(arrival_(k-1), t_k + spread u_k),  u_k drawn evenly from 0 ... 1, in whole steps
// Source: textbook (shared bus). Not in the thesis.
#include "sim/effects/effect.h"

#include <algorithm>
#include <cmath>

#include "sim/effects/random_number.h"
#include "sim/integrate/plant.h"

namespace slewlab::sim {

namespace {

class CommandJitter : public Running<CommandJitter> {
 public:
  explicit CommandJitter(const EffectStart& start)
      : spread_(start.value("spread")),
        step_(start.model.step),
        seed_(start.seed),
        waiting_(static_cast<std::size_t>(std::ceil(spread_ / step_)) + 2) {}

  void message(double time, DriveCommand& command) override {
    if (!any_ || command.sequence != newest_) {
      any_ = true;
      newest_ = command.sequence;
      const double delay = spread_ * uniform_number(seed_, static_cast<std::uint64_t>(command.sequence));
      last_arrival_ = std::max(last_arrival_, time + delay);
      waiting_[(first_ + count_) % waiting_.size()] = {last_arrival_, command};
      count_ = std::min(count_ + 1, waiting_.size());
    }
    // Half a step of grace: times are sums of steps and round.
    while (count_ > 0 && waiting_[first_].arrival < time + 0.5 * step_) {
      arrived_ = waiting_[first_].command;
      first_ = (first_ + 1) % waiting_.size();
      --count_;
    }
    command = arrived_;
  }

 private:
  struct Waiting {
    double arrival = 0.0;  // [s]
    DriveCommand command;
  };
  double spread_, step_;
  std::uint64_t seed_;
  std::vector<Waiting> waiting_;  // a ring; a step brings one message at most
  std::size_t first_ = 0, count_ = 0;
  double last_arrival_ = 0.0;
  std::int64_t newest_ = 0;
  bool any_ = false;
  DriveCommand arrived_;
};

}  // namespace

const EffectDescription& command_jitter() {
  static const EffectDescription description{
      .about = {.name = "command_jitter",
                .subsystem = common::Subsystem::wire,
                .physics = "commands arrive late by changing times",
                .parameters = {{.name = "spread",
                                .unit = common::Unit::second,
                                .per = common::ScaleOf::time,
                                .meaning = "longest delay",
                                .lower = 0.0,
                                .upper = 0.1986,
                                .typical = 0.0397,
                                .prior_scale = 0.01985,
                                .scale = common::ParameterScale::linear,
                                .absent = 0.0}},
                .family = common::Family::delay,
                .stochastic = common::Stochastic{.power_exponent = 2.0},
                .acts_late = true,
                .before_torque = true},
      .ports = {EffectPort::message},
      .start = [](const EffectStart& start) -> std::unique_ptr<RunningEffect> {
        return std::make_unique<CommandJitter>(start);
      }};
  return description;
}

}  // namespace slewlab::sim
