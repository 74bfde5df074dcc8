// What a run in the loop says, in memory, as the log of the same run in lockstep holds it: each channel's messages with
// their heads, in their order.
#pragma once

#include "diagnosis/loop/loop.h"
#include "msgs/run_log.h"

namespace slewlab::diagnosis {

// [ns] from one message to the next; whole plant steps. Never with sim::kNever.
struct LogPeriods {
  std::int64_t sensors = 1'000'000;
  std::int64_t truth = 10'000'000;
  std::int64_t status = 100'000'000;
};

class LoopLog {
 public:
  // `controller`, where there is one, for TORQUE and CONTROLLER_STATE. Keeps references to all of them.
  LoopLog(const LoopCourse& course, sim::DrivenPlant& plant, const LogPeriods& periods, const ControllerAnswer* controller = nullptr);

  // For the run that begins now.
  LoopHooks hooks();

  msgs::RunLog log;

 private:
  void add_series(std::int64_t time);

  const LoopCourse& course_;
  sim::DrivenPlant& plant_;
  LogPeriods periods_;
  const ControllerAnswer* controller_;
};

// A whole machine's run.
msgs::RunLog logged_run(const LoopSettings& settings, const LogPeriods& periods);

}  // namespace slewlab::diagnosis
