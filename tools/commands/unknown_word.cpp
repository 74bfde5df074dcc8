#include "tools/commands/unknown_word.h"

#include <algorithm>

#include "common/near_name.h"

namespace slewlab::tools {
namespace {

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

// Those that --help lists: without a group a command is hidden.
std::vector<std::string> shown_command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) {
    if (!command->get_group().empty()) names.push_back(command->get_name());
  }
  return names;
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options({})) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

const CLI::Option* option_of(const CLI::App& app, const std::string& name) {
  for (const CLI::Option* option : app.get_options({})) {
    if (option->check_name(name)) return option;
  }
  return nullptr;
}

std::string refusal(const std::string& command, const std::string& word, const char* what, const std::vector<std::string>& known) {
  return command + ": '" + word + "' is no " + what + " of it, expected " + common::known_names_text(word, known);
}

}  // namespace

std::optional<std::string> unknown_word(const CLI::App& app, const std::vector<std::string>& words) {
  const CLI::App* command = &app;
  std::string name = app.get_name();
  for (std::size_t i = 1; i < words.size(); ++i) {
    if (command->get_prefix_command()) return std::nullopt;  // what follows is another program's
    const std::string& word = words[i];
    if (word == "--") return std::nullopt;
    if (word.starts_with("--")) {
      const std::string option_name = word.substr(0, word.find('='));
      const CLI::Option* option = option_of(*command, option_name);
      if (option == nullptr) {
        return refusal(name, option_name, "option", option_names(*command));
      }
      if (option->get_items_expected_max() > 0 && word.find('=') == std::string::npos) ++i;  // its value
      continue;
    }
    const std::vector<std::string> commands = command_names(*command);
    if (commands.empty() || word.starts_with('-')) continue;
    if (std::find(commands.begin(), commands.end(), word) == commands.end()) {
      return refusal(name, word, "command", shown_command_names(*command));
    }
    command = command->get_subcommand(word);
    name += ' ' + word;
  }
  return std::nullopt;
}

bool names_no_command(const CLI::App& app, const std::vector<std::string>& words) {
  if (words.size() < 2 || words[1].empty() || words[1][0] == '-') return false;
  const std::vector<std::string> names = command_names(app);
  return std::find(names.begin(), names.end(), words[1]) == names.end();
}

}  // namespace slewlab::tools
