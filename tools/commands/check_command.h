// `slewlab check FILE...`: reads cranes, controllers and scenarios as a run would and says what is wrong.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "common/input_error.h"
#include "common/yaml_file.h"

namespace slewlab::tools {

struct FileFindings {
  common::InputProblems problems;     // what a run would refuse
  std::vector<std::string> warnings;  // what is possible and yet unlikely, or takes long: a line each, with file and key
};

// A controller by the user need not be one of ours: its file is left to it.
enum class ControllerBy { slewlab, user };

// All that is to be said of one file, whichever kind it says it is (`kind: crane | controller | scenario`). A scenario is
// examined with the crane and the controller that it names, and how they fit together; effects against the catalogue, and
// whether the crane with them can be built.
FileFindings examine(const std::filesystem::path& file, const std::vector<common::Override>& overrides = {},
                 ControllerBy by = ControllerBy::slewlab);

// The problem of a file that says it is of another kind than this one; none where it cannot be read or says nothing.
common::InputProblems problems_of_another_kind(const std::filesystem::path& file, const std::string& wanted);

// What the file says under `kind:`; empty where it cannot be read or says nothing.
std::string kind_in(const std::filesystem::path& file);

// One problem a line, the first hundred of them.
void complain(const common::InputProblems& problems, std::ostream& complaints);

void warn(const std::vector<std::string>& warnings, std::ostream& complaints);

// Prints "FILE: OK" to `out` or the problems, one a line, to `complaints`, for each file; warnings
// go there as well and change no exit code. Answers with the exit code: 0 when all is well, 1 when any file has a problem.
int check_files(const std::vector<std::filesystem::path>& files,
                const std::vector<common::Override>& overrides, std::ostream& out, std::ostream& complaints);

}  // namespace slewlab::tools
