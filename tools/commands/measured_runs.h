// The logs that a diagnosis is asked of, run by run.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "msgs/logged_run.h"
#include "msgs/run_log.h"

namespace slewlab::tools {

template <class Run>
struct RunOf {
  std::string name;                  // the log's; where it holds several runs with the run's number
  Run run;
  std::vector<std::string> remarks;  // of the whole log, beside its last run
};

template <class Run>
struct RunsOf {
  std::vector<RunOf<Run>> runs;
  bool is_damaged = false;  // bytes or messages of a log were lost
};

// In memory as a whole, or by their order alone.
using MeasuredRun = RunOf<msgs::RunLog>;
using MeasuredRuns = RunsOf<msgs::RunLog>;
using LoggedRun = RunOf<msgs::LoggedRun>;
using LoggedRuns = RunsOf<msgs::LoggedRun>;

// Both throw msgs::LogError.
LoggedRuns logged_runs(const std::vector<std::filesystem::path>& logs);
MeasuredRuns measured_runs(const std::vector<std::filesystem::path>& logs);

// Said with the answer and not only in a note: what is lost may be where the gap was.
inline constexpr const char* kOfADamagedLog = " (from the readable part of a damaged log)";

}  // namespace slewlab::tools
