// `slewlab diagnose`: measured logs against a nominal crane; writes diagnosis.json, crane_with_effect.yaml and the
// series that the plots are drawn from, and prints one page (docs/diagnosis/how_to.md).
#pragma once

#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace slewlab::tools {

struct DiagnoseOptions {
  std::filesystem::path crane, controller;
  std::vector<std::filesystem::path> logs;
  std::vector<std::filesystem::path> unseen;  // that the answer is tried on and that have no part in it
  std::filesystem::path out;
  std::vector<std::string> without;  // effects that the catalogue is to do without; of an axis: laws of its torque balance
  std::optional<int> threads;        // of a crane, two without it
  std::optional<double> fitted_seconds;  // of all logs together, at most; what of longer ones is fitted: long_logs.h
  bool is_torque_measured = false;   // of a crane: the logs' torques are no commands
  bool terminal = false;  // progress is one line that is written over, not a line every two seconds
};

inline constexpr int kCannotTell = 3;  // exit code

// Answers with the exit code: 0 diagnosed, 1 the work failed, 2 the options, a file or a log is wrong, 3 "cannot tell, because" (said on
// `complaints`), 128 with the signal's number interrupted. Files appear whole or not at all.
int diagnose_logs(const DiagnoseOptions& options, std::ostream& out, std::ostream& complaints);

// What --without takes, of cranes, controllers and axes.
std::vector<std::string> names_left_out();

}  // namespace slewlab::tools
