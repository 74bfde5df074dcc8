// The logs that a diagnosis is asked of, run by run.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "msgs/run_log.h"

namespace slewlab::tools {

struct MeasuredRun {
  std::string name;                  // the log's; where it holds several runs with the run's number
  msgs::RunLog run;
  std::vector<std::string> remarks;  // of the whole log, beside its last run
};

struct MeasuredRuns {
  std::vector<MeasuredRun> runs;
  bool is_damaged = false;  // bytes or messages of a log were lost
};

// Throws msgs::LogError.
MeasuredRuns measured_runs(const std::vector<std::filesystem::path>& logs);

// Said with the answer and not only in a note: what is lost may be where the gap was.
inline constexpr const char* kOfADamagedLog = " (from what is left of a damaged log)";

}  // namespace slewlab::tools
