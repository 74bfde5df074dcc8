// What is unknown on the command line of a program with no commands of its own.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace slewlab::common {

// "slewlab-plant: '--ste' is no option of it, expected '--set' (or one of ...)"; nothing where every option is known. `words` begin with
// the program's name, `known` are as "--set".
std::optional<std::string> unknown_option(const std::string& program, const std::vector<std::string>& words, const std::vector<std::string>& known);

}  // namespace slewlab::common
