#pragma once

// The runs of a log of which only the order is in memory, 24 bytes per message (msgs/run_order.h), so that of a log of hours a part can be
// chosen and read without the rest.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "msgs/run_log.h"
#include "msgs/run_order.h"

namespace slewlab::msgs {

struct LoggedRun {
  std::filesystem::path path;
  OrderedRun order;
};

struct LoggedRuns {
  std::vector<LoggedRun> runs;       // in the order in which they begin in the file
  std::vector<std::string> remarks;  // and the rest as in RunLogs (msgs/run_log.h)
  std::int64_t lost_bytes = 0;
  std::int64_t lost_messages = 0;
};

// Each throws LogError: the first where the file cannot be read or holds no message of slewlab, the others where it changed since.
LoggedRuns logged_runs(const std::filesystem::path& path);

// The run as a whole.
RunLog read_run(const LoggedRun& run);

// The run as a recorder would have it that was on from `from` to `to` alone [ns, both belong to it] and that heard what stood before: of
// OPERATOR and PLANT_STATUS, which hold until the next one, the last one before is with it.
RunLog read_run(const LoggedRun& run, std::int64_t from, std::int64_t to);

// The first ENCODER, and of the others each that lies at least `distance` [ns] behind the one before.
std::vector<Encoder> read_encoders(const LoggedRun& run, std::int64_t distance);

}  // namespace slewlab::msgs
