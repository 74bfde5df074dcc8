// Of logs that are longer together than a diagnosis fits, the stretches that it fits and those that the answer is tried on (diagnosis/stretch.h).
#pragma once

#include <functional>
#include <vector>

#include "tools/commands/measured_runs.h"

namespace slewlab::tools {

struct LongLogSettings {
  double most = 0.0;      // [s] of all logs, that is fitted
  double shortest = 0.0;  // [s] of a log, below which nothing of it is
  double time = 0.0;      // [s] characteristic time of the machine
  double least_judged = 0.0;
  // The share of a run that would be judged; throws std::runtime_error where it is refused. A stretch of which less than the least is judged is passed over as one that is refused.
  std::function<double(const MeasuredRun&)> judged_share;
};

// Cuts the runs to what is fitted of them, the stretch in which most moves in what is judged of it, which their names and remarks say; logs that are no longer together stay as they
// are, and so does one of which no stretch can be judged: it says itself why. Gives of each that was cut the next best stretch: it has no part in the answer.
std::vector<MeasuredRun> keep_stretches(const LongLogSettings& settings, MeasuredRuns& measured);

}  // namespace slewlab::tools
