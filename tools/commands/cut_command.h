// `slewlab cut LOG --from S --until S --out PIECE`: a piece of a log as a log (msgs/log_piece.h), for what a record has before and behind a gap, a trip, a change.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <optional>

namespace slewlab::tools {

struct CutOptions {
  std::filesystem::path log = {};       // or the folder of a run
  std::filesystem::path out = {};
  std::optional<double> from = {}, until = {};  // [s] of the run; the run's first and last message
  int run = 0;                          // of several in the file, from 1; 0: there is one
};

// Answers with the exit code 0; `out` appears when it is complete. Throws common::InputError where the log or the times are no good, msgs::LogError where the
// piece cannot be written.
int cut(const CutOptions& options, std::ostream& out);

}  // namespace slewlab::tools
