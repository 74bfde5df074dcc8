// The lockstep with its wire in one process: the plant's loop (sim/drive/lockstep_loop.h) and the controller's answers
// (controller/process/answer_loop.h) on a bus in memory, bytes, repeated questions and faults on purpose included. What a
// run in two processes logs, to the byte; for whoever wants the wire itself in the test. Without it: loop.h.
#pragma once

#include "controller/controller.h"
#include "controller/process/answer_loop.h"
#include "sim/drive/lockstep_loop.h"

namespace slewlab::diagnosis {

// Repeated questions without an answer after which the controller counts as dead and the run ends.
inline constexpr int kUnansweredQuestions = 1000;

struct WireLoopResult {
  sim::LockstepCounts counts;
  bool controller_is_dead = false;  // nobody answered any more, and the run ended there
};

// Starts the controller anew: what it knew before is lost.
using NewController = std::function<controller::Compute()>;

// A controller that a fault kills or starts (`controller_action`) is that of this run; the hook is told behind it. Throws
// as run_lockstep() does.
WireLoopResult run_wire_loop(const sim::LockstepSettings& settings, const NewController& controller, sim::DrivenPlant& plant,
                             const sim::LogSink& log, const sim::LockstepHooks& hooks = {});
WireLoopResult run_wire_loop(const sim::LockstepSettings& settings, const controller::ControllerSettings& controller,
                             sim::DrivenPlant& plant, const sim::LogSink& log, const sim::LockstepHooks& hooks = {});
WireLoopResult run_wire_loop(const sim::LockstepSettings& settings, const controller::ControllerSettings& controller,
                             sim::DrivenPlant& plant, msgs::LogWriter& log);

}  // namespace slewlab::diagnosis
