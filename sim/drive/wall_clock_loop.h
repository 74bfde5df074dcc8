#pragma once

// The plant's side against the wall clock: one plant step at each due time start + i * step / speed, by absolute
// wake-ups, so that nothing drifts. The controller is asked every period and not waited for: the drive holds the last
// command, and its timeouts run in simulated time, that is they scale with the speed. A step that is late is made up
// for, none is left out.
//
// The clock starts with the controller's first answer. Until then ENCODER 0 is sent again and again.
//
// A deadline is missed where a step's work ends after the next one is due. It is the plant's own doing where the work
// alone, by the thread's own processor time, was longer than the step; otherwise the machine had something else to do.
//
// Of what comes on TORQUE within one period, the drive takes a few messages that are none and a thousand that are (those
// of a controller that was stopped come all at once); the rest is counted and left out.
//
// Faults on purpose (fault_injector.h) act as in lockstep, but what is drawn acts on whatever message comes.
//
// The thread that runs it does no file I/O: the log goes to a function handed in (msgs/log_queue.h).

#include <cstdint>
#include <functional>

#include "msgs/bus.h"
#include "sim/drive/driven_plant.h"
#include "sim/drive/latency_histogram.h"
#include "sim/drive/lockstep_loop.h"

namespace slewlab::sim {

// Time as the loop sees it. [ns]
class LoopClock {
 public:
  virtual ~LoopClock() = default;
  virtual std::int64_t now() = 0;
  virtual void sleep_until(std::int64_t time) = 0;
  virtual std::int64_t processor_time() = 0;  // used by this thread
};

struct WallClockReport {
  std::int64_t simulated_time = 0;  // [ns] reached
  std::int64_t cycles = 0;          // controller periods
  std::int64_t foreign_answers = 0;  // TORQUE of another run, left alone
  std::int64_t cut_answers = 0;      // on TORQUE, longer than kLargestAnswer: the rest is left out
  std::int64_t flooding_answers = 0; // on TORQUE, more than a period takes: neither drive nor log gets them
  std::int64_t missed_deadlines = 0;
  std::int64_t missed_by_own_computation = 0;  // of these
  LatencyHistogram wakeup_latency;             // from due to awake
  LatencyHistogram step_time;                  // from awake to done
  bool ended_by_operator = false;              // of a run that is steered
};

struct WallClockHooks {
  std::function<SteeredPeriod(std::int64_t)> steer;  // as of LockstepHooks; must not wait
  std::function<bool()> stop;                              // asked in every step
  std::function<void(const WallClockReport&)> after_cycle;
  std::function<void(const WallClockReport&)> while_waiting;  // for the first answer, whenever it is asked again
  std::function<void(ControllerAction)> controller_action;  // must not wait
};

// Takes the settings of a lockstep run; resends do not occur. `speed` is simulated seconds per second. Throws
// std::invalid_argument, PlantDiverged, msgs::BusError.
WallClockReport run_wall_clock(const LockstepSettings& settings, double speed, DrivenPlant& plant, msgs::Bus& bus,
                               const LogSink& log, LoopClock& clock, const WallClockHooks& hooks = {});

}  // namespace slewlab::sim
