#include "msgs/run_log.h"

#include <utility>

#include "msgs/logged_run.h"

namespace slewlab::msgs {

RunLogs read_run_logs(const std::filesystem::path& path) {
  LoggedRuns logged = logged_runs(path);
  RunLogs logs{{}, std::move(logged.remarks), logged.lost_bytes, logged.lost_messages};
  for (LoggedRun& run : logged.runs) {
    logs.runs.push_back(read_run(run));
    run = {};
  }
  return logs;
}

}  // namespace slewlab::msgs
