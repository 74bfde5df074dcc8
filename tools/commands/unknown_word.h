// What is unknown on a command line that was refused: the command or option, and which one was meant.
#pragma once

#include <CLI/CLI.hpp>

#include <optional>
#include <string>
#include <vector>

namespace slewlab::tools {

// "slewlab run: '--contoller' is no option of it, expected '--controller' (or one of ...)"; nothing where every command and
// option is known. `words` begin with the program's own name.
std::optional<std::string> unknown_word(const CLI::App& app, const std::vector<std::string>& words);

// The first of the words behind the program's name is meant for a command, and there is none of that name.
bool names_no_command(const CLI::App& app, const std::vector<std::string>& words);

}  // namespace slewlab::tools
