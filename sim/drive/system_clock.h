#pragma once

// The machine's own clock for run_wall_clock, and what can be had of a machine to keep its deadlines.

#include <string>
#include <vector>

#include "sim/drive/wall_clock_loop.h"

namespace slewlab::sim {

// CLOCK_MONOTONIC; sleeps to absolute times, a signal does not wake it early.
class SystemClock : public LoopClock {
 public:
  std::int64_t now() override;
  void sleep_until(std::int64_t time) override;
  std::int64_t processor_time() override;
};

// Scheduling by SCHED_FIFO for this thread and all memory locked, where that is permitted. Answers with one line for
// each of the two, saying whether it was and, if not, what would permit it.
std::vector<std::string> ask_for_real_time();

}  // namespace slewlab::sim
