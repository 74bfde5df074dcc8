#include "tools/commands/command_pages.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

namespace slewlab::tools {
namespace {

// As roff takes text: a dash that is one, no control line by accident.
std::string roff(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '\\') {
      escaped += "\\e";
    } else if (c == '-') {
      escaped += "\\-";
    } else if ((c == '.' || c == '\'') && (escaped.empty() || escaped.back() == '\n')) {
      escaped += std::string("\\&") + c;
    } else {
      escaped += c;
    }
  }
  return escaped;
}

std::vector<const CLI::App*> shown_commands(const CLI::App& app) {
  std::vector<const CLI::App*> shown;
  for (const CLI::App* command : app.get_subcommands({})) {
    if (!command->get_group().empty()) shown.push_back(command);  // without a group it is hidden
  }
  return shown;
}

std::vector<ForeignOption> options_of(const CLI::App& app, const ForeignOptions& foreign) {
  if (app.get_prefix_command()) {
    const auto found = foreign.find(app.get_name());
    return found == foreign.end() ? std::vector<ForeignOption>{} : found->second;
  }
  std::vector<ForeignOption> options;
  for (const CLI::Option* option : app.get_options({})) {
    options.push_back({option->get_name(option->get_positional(), true), option->get_description(), option->get_positional()});
  }
  return options;
}

std::string options_part(const std::vector<ForeignOption>& taken) {
  std::string positionals, options;
  for (const ForeignOption& option : taken) {
    std::string& part = option.is_positional ? positionals : options;
    part += ".TP\n.B " + roff(option.name) + "\n" + roff(option.description) + "\n";
  }
  return (positionals.empty() ? "" : ".SH ARGUMENTS\n" + positionals) + (options.empty() ? "" : ".SH OPTIONS\n" + options);
}

std::string commands_part(const CLI::App& app, const std::string& name) {
  std::string text;
  for (const CLI::App* command : shown_commands(app)) {
    text += ".TP\n.B " + roff(name + ' ' + command->get_name()) + "\n" + roff(command->get_description()) + "\n";
  }
  return text.empty() ? "" : ".SH COMMANDS\n" + text;
}

CommandPage page_of(const CLI::App& app, const std::string& name, const std::string& footer, const std::string& version,
                    const ForeignOptions& foreign) {
  const std::vector<ForeignOption> options = options_of(app, foreign);
  std::string title = name;
  for (char& c : title) c = c == ' ' ? '-' : c;
  std::string text = ".TH " + roff(title) + " 1 \"\" \"slewlab " + version + "\"\n.SH NAME\n" + roff(title) + " \\- " +
                     roff(app.get_description()) + "\n.SH SYNOPSIS\n.B " + roff(name) + "\n";
  for (const CLI::Option* option : app.get_options({})) {
    if (option->get_positional()) text += roff(option->get_required() ? option->get_name(true) : '[' + option->get_name(true) + ']') + "\n";
  }
  text += shown_commands(app).empty() ? "[options]\n" : "COMMAND [options]\n";
  text += options.empty() ? ".SH OPTIONS\nAs told by\n.BR \"" + roff(name + " --help") + "\" .\n" : options_part(options);
  text += commands_part(app, name);
  if (!footer.empty()) text += ".SH EXIT STATUS\n" + roff(footer) + "\n";
  return {title + ".1", text};
}

std::string option_words(const CLI::App& app, const ForeignOptions& foreign) {
  std::string words;
  for (const ForeignOption& option : options_of(app, foreign)) {
    if (option.is_positional) continue;
    for (std::size_t begin = 0; begin < option.name.size();) {
      const std::size_t end = std::min(option.name.find(',', begin), option.name.size());
      const std::string name = option.name.substr(begin, end - begin);
      if (name.starts_with("--")) words += (words.empty() ? "" : " ") + name;
      begin = end + 1;
    }
  }
  return words;
}

}  // namespace

ForeignOptions read_foreign_options(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return {};
  std::ifstream in(file);
  ForeignOptions foreign;
  try {
    const nlohmann::json told = nlohmann::json::parse(in);
    for (const auto& [command, options] : told.items()) {
      for (const auto& option : options) foreign[command].push_back({option.at(0), option.at(1), option.at(2)});
    }
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error(file.string() + ": not what describe_commands.py writes: " + error.what());
  }
  return foreign;
}

std::vector<CommandPage> manual_pages(const CLI::App& app, const std::string& version, const ForeignOptions& foreign) {
  const std::string footer = app.get_footer();
  std::vector<CommandPage> pages{page_of(app, app.get_name(), footer, version, foreign)};
  for (const CLI::App* command : shown_commands(app)) {
    pages.push_back(page_of(*command, app.get_name() + ' ' + command->get_name(), footer, version, foreign));
    for (const CLI::App* below : shown_commands(*command)) {
      pages.push_back(page_of(*below, app.get_name() + ' ' + command->get_name() + ' ' + below->get_name(), footer, version, foreign));
    }
  }
  return pages;
}

std::string completion_script(const CLI::App& app, const ForeignOptions& foreign) {
  std::string commands, cases;
  for (const CLI::App* command : shown_commands(app)) {
    commands += (commands.empty() ? "" : " ") + command->get_name();
    std::string words = option_words(*command, foreign);
    for (const CLI::App* below : shown_commands(*command)) words += ' ' + below->get_name() + ' ' + option_words(*below, foreign);
    if (!words.empty()) cases += "    " + command->get_name() + ") words=\"" + words + "\" ;;\n";
  }
  return "# Completion of slewlab for bash: source <(slewlab completion). For zsh: autoload bashcompinit; bashcompinit before it.\n"
         "_slewlab() {\n"
         "  local word=\"${COMP_WORDS[COMP_CWORD]}\" words=\"\"\n"
         "  if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
         "    COMPREPLY=($(compgen -W \"" + commands + ' ' + option_words(app, foreign) + "\" -- \"$word\"))\n"
         "    return\n"
         "  fi\n"
         "  case \"${COMP_WORDS[1]}\" in\n" + cases +
         "  esac\n"
         "  COMPREPLY=($(compgen -W \"$words\" -- \"$word\") $(compgen -f -- \"$word\"))\n"
         "}\n"
         "complete -o filenames -F _slewlab slewlab\n";
}

}  // namespace slewlab::tools
