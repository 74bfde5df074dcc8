#include "tools/commands/measured_runs.h"

#include <fmt/format.h>

#include <utility>

#include "tools/commands/log_path.h"

namespace slewlab::tools {

MeasuredRuns measured_runs(const std::vector<std::filesystem::path>& logs) {
  MeasuredRuns measured;
  for (const std::filesystem::path& given : logs) {
    const std::filesystem::path log = log_in(given);
    msgs::RunLogs read = msgs::read_run_logs(log);
    const std::size_t count = read.runs.size();
    for (std::size_t r = 0; r < count; ++r) {
      measured.runs.push_back({count == 1 ? log.string() : fmt::format("{} run {}", log.string(), r + 1), std::move(read.runs[r]), {}});
    }
    std::vector<std::string>& remarks = measured.runs.back().remarks;
    for (const std::string& remark : read.remarks) remarks.push_back(log.string() + ": " + remark);
    if (count > 1) {
      remarks.push_back(fmt::format("{}: holds {} runs, or one whose clock was set back; each is judged on its own", log.string(), count));
    }
    measured.is_damaged = measured.is_damaged || read.lost_bytes > 0 || read.lost_messages > 0;
  }
  return measured;
}

}  // namespace slewlab::tools
