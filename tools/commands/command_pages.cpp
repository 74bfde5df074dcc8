#include "tools/commands/command_pages.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
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

// The words of a validator one_of (option_check.h), which names itself "{a,b}".
std::vector<std::string> choices_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t begin = type.find('{'), end = type.rfind('}');
  if (begin == std::string::npos || end == std::string::npos || end < begin) return {};
  std::vector<std::string> choices;
  std::istringstream words(type.substr(begin + 1, end - begin - 1));
  for (std::string word; std::getline(words, word, ',');) choices.push_back(word);
  return choices;
}

// Of a command whose command line another program reads also what it takes behind its first word, if `with_below`.
std::vector<ForeignOption> options_of(const CLI::App& app, const ForeignOptions& foreign, bool with_below, const OptionWords& words = {}) {
  std::vector<ForeignOption> options;
  if (app.get_prefix_command()) {
    for (const auto& [command, taken] : foreign) {
      if (command != app.get_name() && !(with_below && command.starts_with(app.get_name() + ' '))) continue;
      for (const ForeignOption& option : taken) {
        const bool is_known = std::any_of(options.begin(), options.end(), [&](const ForeignOption& other) { return other.name == option.name; });
        if (!is_known) options.push_back(option);
      }
    }
    return options;
  }
  for (const CLI::Option* option : app.get_options({})) {
    const std::string name = option->get_name(option->get_positional(), true);
    const auto more = words.find(name);
    options.push_back({name, option->get_description(), option->get_positional(), more == words.end() ? choices_of(*option) : more->second});
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
  const std::vector<ForeignOption> options = options_of(app, foreign, true);
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

std::string joined(const std::vector<std::string>& words, const char* between) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : between) + word;
  return text;
}

std::vector<std::string> long_names(const ForeignOption& option) {
  std::vector<std::string> names;
  std::istringstream all(option.name);
  for (std::string name; std::getline(all, name, ',');) {
    if (name.starts_with("--")) names.push_back(name);
  }
  return names;
}

// Shell lines that set `words`, and behind an option whose value is one of a few words those, and no files.
std::string answer_with(const std::vector<ForeignOption>& options, std::vector<std::string> words) {
  std::string values;
  for (const ForeignOption& option : options) {
    if (option.is_positional) {
      words.insert(words.end(), option.choices.begin(), option.choices.end());
      continue;
    }
    const std::vector<std::string> names = long_names(option);
    words.insert(words.end(), names.begin(), names.end());
    if (!option.choices.empty() && !names.empty()) values += ' ' + joined(names, "|") + ") words=\"" + joined(option.choices, " ") + "\" files=no ;;";
  }
  return "words=\"" + joined(words, " ") + "\"" + (values.empty() ? "" : "; case \"$before\" in" + values + " esac");
}

// The answer to what stands behind a command.
std::string answer_of(const CLI::App& command, const ForeignOptions& foreign, const OptionWords& words) {
  std::vector<std::string> names;
  std::string below;
  for (const CLI::App* each : shown_commands(command)) {
    names.push_back(each->get_name());
    below += "        " + each->get_name() + ") " + answer_with(options_of(*each, foreign, false, words), {}) + " ;;\n";
  }
  if (command.get_prefix_command()) {
    const std::string beginning = command.get_name() + ' ';
    for (const auto& [name, options] : foreign) {
      if (name.starts_with(beginning)) below += "        " + name.substr(beginning.size()) + ") " + answer_with(options, {}) + " ;;\n";
    }
  }
  const std::string own = answer_with(options_of(command, foreign, false, words), names);
  return below.empty() ? own : "case \"$below\" in\n" + below + "        *) " + own + " ;;\n      esac";
}

}  // namespace

ForeignOptions read_foreign_options(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return {};
  std::ifstream in(file);
  ForeignOptions foreign;
  try {
    const nlohmann::json told = nlohmann::json::parse(in);
    for (const auto& [command, options] : told.items()) {
      for (const auto& option : options) {
        foreign[command].push_back({option.at(0), option.at(1), option.at(2), option.size() > 3 ? option.at(3).get<std::vector<std::string>>() : std::vector<std::string>{}});
      }
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

CommandPage page_of_help(const std::string& name, const std::string& help, const std::string& version) {
  std::istringstream lines(help);
  std::string description, line, usage = name + " [OPTIONS]", options;
  std::getline(lines, description);
  while (std::getline(lines, line)) {
    if (line.starts_with("Usage: ")) {
      usage = line.substr(line.find(' ') + 1);
    } else if (!line.empty() && line != "Options:" && line != "Positionals:") {
      options += line + "\n";
    }
  }
  return {name + ".1", ".TH " + roff(name) + " 1 \"\" \"slewlab " + version + "\"\n.SH NAME\n" + roff(name) + " \\- " + roff(description) +
                           "\n.SH SYNOPSIS\n.B " + roff(usage) + "\n.SH OPTIONS\n.nf\n" + roff(options) + ".fi\n"};
}

std::string completion_script(const CLI::App& app, const ForeignOptions& foreign, const OptionWords& words) {
  std::vector<std::string> commands;
  std::string cases;
  for (const CLI::App* command : shown_commands(app)) {
    commands.push_back(command->get_name());
    cases += "    " + command->get_name() + ") " + answer_of(*command, foreign, words) + " ;;\n";
  }
  return "# Completion of slewlab for bash: source <(slewlab completion). For zsh: autoload bashcompinit; bashcompinit before it.\n"
         "_slewlab() {\n"
         "  local word=\"${COMP_WORDS[COMP_CWORD]}\" before=\"${COMP_WORDS[COMP_CWORD - 1]}\" below=\"\" words=\"\" files=yes\n"
         "  if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
         "    " + answer_with(options_of(app, foreign, false), commands) + "\n"
         "    COMPREPLY=($(compgen -W \"$words\" -- \"$word\"))\n"
         "    return\n"
         "  fi\n"
         "  [ \"$COMP_CWORD\" -gt 2 ] && below=\"${COMP_WORDS[2]}\"\n"
         "  case \"${COMP_WORDS[1]}\" in\n" + cases +
         "  esac\n"
         "  COMPREPLY=($(compgen -W \"$words\" -- \"$word\"))\n"
         "  if [ \"$files\" = yes ]; then COMPREPLY+=($(compgen -f -- \"$word\")); fi\n"
         "}\n"
         "complete -o filenames -F _slewlab slewlab\n";
}

}  // namespace slewlab::tools
