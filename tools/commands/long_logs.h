// Of logs that are longer together than a diagnosis fits, the stretches that it fits and those that the answer is tried on (diagnosis/stretch.h). Only they are held in
// memory, however long the logs are.
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

struct FittedRuns {
  MeasuredRuns fitted;
  MeasuredRuns unseen;  // of each that was cut the next best stretch: it has no part in the answer
};

// What is fitted of the runs: of each the stretch in which most moves in what is judged of it, which names and remarks say; logs that are no longer together are read whole, and
// so is one of which no stretch can be judged: it says itself why. Throws msgs::LogError where a log changed since its order was read.
FittedRuns fitted_runs(const LongLogSettings& settings, LoggedRuns&& logged);

}  // namespace slewlab::tools
