// Pages about the commands, out of what --help knows: manual pages, and completion for shells.
#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace slewlab::tools {

struct CommandPage {
  std::string name;  // of the file: slewlab-run.1
  std::string text;  // roff
};

// slewlab(1), and one page for every command. `version`: "0.2.0".
std::vector<CommandPage> manual_pages(const CLI::App& app, const std::string& version);

// For bash, and for zsh by bashcompinit: commands, their options, and files.
std::string completion_script(const CLI::App& app);

}  // namespace slewlab::tools
