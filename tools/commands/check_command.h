// `slewlab check FILE...`: reads cranes, controllers and scenarios as a run would and says what is wrong.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <vector>

#include "common/input_error.h"
#include "common/yaml_file.h"

namespace slewlab::tools {

// Everything wrong with one file, whichever kind it says it is (`kind: crane | controller | scenario`). A
// scenario is checked with the crane and the controller that it names, and how they fit together.
common::InputProblems problems_in(const std::filesystem::path& file,
                                  const std::vector<common::Override>& overrides = {});

// Prints "FILE: OK" to `out` or the problems, one a line, to `complaints`, for each file. Answers with the
// exit code: 0 when all is well, 1 when any file has a problem.
int check_files(const std::vector<std::filesystem::path>& files,
                const std::vector<common::Override>& overrides, std::ostream& out, std::ostream& complaints);

}  // namespace slewlab::tools
