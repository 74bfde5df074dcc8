#include "diagnosis/loop/wire_loop.h"

#include <memory>

#include "controller/process/answer_loop.h"
#include "controller/process/computed_answer.h"
#include "msgs/memory_bus.h"

namespace slewlab::diagnosis {
namespace {

// The controller as a process would be: killed, nothing of it is left.
struct ControllerProcess {
  ControllerProcess(msgs::MemoryWire& wire, const NewController& controller) : bus(wire.connect()), loop(*bus, controller()) {}
  std::unique_ptr<msgs::MemoryBus> bus;
  controller::AnswerLoop loop;
};

}  // namespace

WireLoopResult run_wire_loop(const sim::LockstepSettings& settings, const NewController& controller, sim::DrivenPlant& plant,
                             const sim::LogSink& log, const sim::LockstepHooks& hooks) {
  msgs::MemoryWire wire;
  const auto plant_bus = wire.connect();
  auto process = std::make_unique<ControllerProcess>(wire, controller);
  plant_bus->on_wait = [&] {
    if (process) process->bus->drain();
  };
  int unanswered = 0;
  sim::LockstepHooks own = hooks;
  own.controller_action = [&](sim::ControllerAction action) {
    process.reset();
    if (action == sim::ControllerAction::start) process = std::make_unique<ControllerProcess>(wire, controller);
    if (hooks.controller_action) hooks.controller_action(action);
  };
  own.while_waiting = [&](const sim::LockstepCounts& counts) {
    ++unanswered;
    if (hooks.while_waiting) hooks.while_waiting(counts);
  };
  own.after_cycle = [&](const sim::LockstepCounts& counts) {
    unanswered = 0;
    if (hooks.after_cycle) hooks.after_cycle(counts);
  };
  own.stop = [&] { return unanswered >= kUnansweredQuestions || (hooks.stop && hooks.stop()); };
  WireLoopResult result;
  result.counts = sim::run_lockstep(settings, plant, *plant_bus, log, own);
  result.controller_is_dead = unanswered >= kUnansweredQuestions;
  return result;
}

WireLoopResult run_wire_loop(const sim::LockstepSettings& settings, const controller::ControllerSettings& controller,
                             sim::DrivenPlant& plant, const sim::LogSink& log, const sim::LockstepHooks& hooks) {
  const NewController computed = [&] { return controller::computed_answer(controller); };
  return run_wire_loop(settings, computed, plant, log, hooks);
}

WireLoopResult run_wire_loop(const sim::LockstepSettings& settings, const controller::ControllerSettings& controller,
                             sim::DrivenPlant& plant, msgs::LogWriter& log) {
  return run_wire_loop(settings, controller, plant,
                       [&](const char* channel, std::int64_t timestamp_us, msgs::Bytes bytes) { log.append(channel, timestamp_us, bytes); });
}

}  // namespace slewlab::diagnosis
