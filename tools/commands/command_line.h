#pragma once

// What slewlab and slewlab-run, which is `slewlab run` alone, have in common.

#include <CLI/CLI.hpp>

#include <functional>
#include <string>
#include <vector>

#include "common/yaml_file.h"

namespace slewlab::tools {

// What a command is to do; answers with the exit code.
using Action = std::function<int()>;

// --set KEY=VALUE, as often as one likes. A word behind it that is no KEY=VALUE is not its.
CLI::Option* add_settings(CLI::App& command, std::vector<std::string>& settings, const std::string& description);
// `--set a=1 b=2 FILE` as `--set a=1 --set b=2 FILE`.
std::vector<std::string> with_one_setting_each(const std::vector<std::string>& words);

// Each KEY=VALUE of --set.
std::vector<common::Override> parse_overrides(const std::vector<std::string>& texts);

// The options of a command that runs a scenario. Keeps references to `command_line` and `action`.
void add_run_options(CLI::App& command, const std::vector<std::string>& command_line, Action& action);

// Reads the command line and does what it asks; what is wrong is said on standard error. Answers with the exit code.
int act(CLI::App& app, const std::vector<std::string>& command_line, const Action& action);

}  // namespace slewlab::tools
