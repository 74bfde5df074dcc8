// `slewlab verify [--json]`: the thesis's numbers computed anew, with deviation and verdict.
#pragma once

#include <filesystem>
#include <iosfwd>

namespace slewlab::tools {

struct VerifyOptions {
  std::filesystem::path config_directory;  // holds cranes/ and controllers/
  bool json = false;
};

// Prints the rows to `out`. Answers with the exit code: 0 when every row that can be reached passes, 1 when one
// misses, 2 when the configuration cannot be read (said on `complaints`).
int verify(const VerifyOptions& options, std::ostream& out, std::ostream& complaints);

}  // namespace slewlab::tools
