#pragma once

// What of a run's summary.json (`slewlab run` writes it) bears on its acceptance.

#include <filesystem>
#include <string>

namespace slewlab::tools {

struct RunSummary {
  bool is_there = false;
  std::string problem{};             // why it cannot be relied on, with its path and what would be right; empty where it can
  std::string why_incomplete{};      // why the run did not come to its end; empty where it did
  std::string log_digest{};          // of the log as the run wrote it; these two are empty where the run is not complete
  std::string configuration_hash{};
};

// Of a run's folder.
RunSummary read_run_summary(const std::filesystem::path& folder);

}  // namespace slewlab::tools
