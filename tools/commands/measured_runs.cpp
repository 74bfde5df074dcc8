#include "tools/commands/measured_runs.h"

#include <fmt/format.h>

#include <utility>

#include "tools/commands/log_path.h"

namespace slewlab::tools {

LoggedRuns logged_runs(const std::vector<std::filesystem::path>& logs) {
  LoggedRuns logged;
  for (const std::filesystem::path& given : logs) {
    const std::filesystem::path log = log_in(given);
    msgs::LoggedRuns read = msgs::logged_runs(log);
    const std::size_t count = read.runs.size();
    for (std::size_t r = 0; r < count; ++r) {
      logged.runs.push_back({count == 1 ? log.string() : fmt::format("{} run {}", log.string(), r + 1), std::move(read.runs[r]), {}});
    }
    std::vector<std::string>& remarks = logged.runs.back().remarks;
    for (const std::string& remark : read.remarks) remarks.push_back(log.string() + ": " + remark);
    if (count > 1) {
      remarks.push_back(fmt::format("{}: holds {} runs, or one whose clock was set back; each is judged on its own", log.string(), count));
    }
    logged.is_damaged = logged.is_damaged || read.lost_bytes > 0 || read.lost_messages > 0;
  }
  return logged;
}

MeasuredRuns measured_runs(const std::vector<std::filesystem::path>& logs) {
  LoggedRuns logged = logged_runs(logs);
  MeasuredRuns measured{{}, logged.is_damaged};
  for (LoggedRun& one : logged.runs) {
    measured.runs.push_back({std::move(one.name), msgs::read_run(one.run), std::move(one.remarks)});
    one.run = {};
  }
  return measured;
}

}  // namespace slewlab::tools
