#include "tools/commands/command_line.h"

#include <algorithm>
#include <cstdio>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/input_error.h"
#include "common/refused_words.h"
#include "tools/commands/option_check.h"
#include "tools/commands/run_command.h"
#include "tools/commands/unknown_word.h"

namespace slewlab::tools {

namespace {

constexpr const char* kSet = "--set";

// KEY=VALUE, where the key is no part of a path.
bool is_setting(const std::string& word) {
  const std::size_t equal = word.find('=');
  return !word.starts_with('-') && equal != std::string::npos && equal > 0 && word.find('/') >= equal;
}

// The command that was given, as far as it was read, and its whole name: "slewlab withhold make".
std::pair<const CLI::App*, std::string> given_command(const CLI::App& app) {
  const CLI::App* command = &app;
  std::string name = app.get_name();
  while (!command->get_subcommands().empty()) {
    command = command->get_subcommands().front();
    name += ' ' + command->get_name();
  }
  return {command, name};
}

// "slewlab new: --crane,--axis is given 2 times, expected once"; empty where something else is wrong.
std::string given_too_often(const CLI::App& app, const CLI::ParseError& error) {
  const std::string said = error.what();
  const std::size_t colon = said.find(": At Most 1 required but received ");
  if (colon == std::string::npos) return {};
  const auto [command, name] = given_command(app);
  const std::vector<const CLI::Option*> options = command->get_options({});
  const auto option = std::find_if(options.begin(), options.end(), [&](const CLI::Option* each) { return each->check_name(said.substr(0, colon)); });
  if (option == options.end()) return {};
  const std::string names = (*option)->get_name(false, true);
  return name + ": " + names + (names.find(',') == std::string::npos ? " is" : ", one option by several names, is") + " given " +
         said.substr(said.rfind(' ') + 1) + " times, expected once";
}

}  // namespace

std::vector<std::string> with_one_setting_each(const std::vector<std::string>& words) {
  std::vector<std::string> result;
  for (std::size_t i = 0; i < words.size(); ++i) {
    result.push_back(words[i]);
    if (words[i] == "--") {
      result.insert(result.end(), words.begin() + static_cast<std::ptrdiff_t>(i) + 1, words.end());
      break;
    }
    if (words[i] != kSet || i + 1 == words.size()) continue;
    result.push_back(words[++i]);
    while (i + 1 < words.size() && is_setting(words[i + 1])) result.insert(result.end(), {kSet, words[++i]});
  }
  return result;
}

CLI::Option* add_settings(CLI::App& command, std::vector<std::string>& settings, const std::string& description) {
  return command.add_option(kSet, settings, description)->expected(1)->take_all()->type_name("KEY=VALUE");
}

std::vector<common::Override> parse_overrides(const std::vector<std::string>& texts) {
  std::vector<common::Override> overrides;
  for (const std::string& text : texts) overrides.push_back(common::parse_override(text));
  return overrides;
}

void add_run_options(CLI::App& command, const std::vector<std::string>& command_line, Action& action) {
  struct Options {
    RunOptions run;
    std::vector<std::string> overrides;
  };
  auto options = std::make_shared<Options>();
  command.add_option("SCENARIO", options->run.scenario, "scenario file")->required();
  CLI::Option* own = command.add_option("--controller", options->run.controller_command,
                                         "shell command of your own controller; it finds its bus in $SLEWLAB_BUS (docs/wire.md)")
                         ->check(shell_command());
  command.add_option("--controller-fmu", options->run.controller_fmu, "controller that is an FMU 2 or 3 for co-simulation (docs/fmu.md)")
      ->check(readable_file())
      ->excludes(own);
  command.add_option("--plant", options->run.plant_command,
                     "shell command of your own plant; it finds its task in $SLEWLAB_PLANT_TASK (docs/wire.md)")
      ->check(shell_command());
  command.add_option("--out", options->run.out, "folder for log and summary (runs/<scenario>)");
  add_settings(command, options->overrides, "key=value: scenario keys as they are, crane.KEY and controller.KEY for those files");
  const std::vector<std::pair<std::string, int>> modes{{"auto", static_cast<int>(Progress::automatic)},
                                                       {"lines", static_cast<int>(Progress::lines)},
                                                       {"none", static_cast<int>(Progress::none)}};
  CLI::Option* realtime = command.add_flag("--realtime", options->run.realtime, "against the wall clock instead of in lockstep");
  command.add_option("--speed", options->run.speed, "with --realtime: simulated seconds per second")
      ->check(positive_number())
      ->needs(realtime);
  command.add_flag("--steered", options->run.steered, "by lines on standard input, as slewlab desk steers a run (docs/desk.md)");
  command.add_option("--progress", options->run.progress, "auto, lines or none")
      ->transform(number_of(modes));
  command.callback([options, &command_line, &action] {
    action = [options, &command_line] {
      options->run.overrides = parse_overrides(options->overrides);
      return run_scenario(options->run, command_line);
    };
  });
}

int act(CLI::App& app, const std::vector<std::string>& command_line, const Action& action) {
  try {
    std::vector<std::string> words = with_one_setting_each(command_line);
    words.erase(words.begin());
    std::reverse(words.begin(), words.end());  // as CLI wants them: the last first
    app.parse(words);
    return action();
  } catch (const CLI::ParseError& error) {
    const bool is_asked = error.get_exit_code() == 0 && !names_no_command(app, command_line);  // for help or the version
    if (const auto unknown = is_asked ? std::nullopt : unknown_word(app, command_line)) {
      std::fprintf(stderr, "%s\n", unknown->c_str());
      return 2;
    }
    if (const std::string repeated = given_too_often(app, error); !repeated.empty()) {
      std::fprintf(stderr, "%s\n", repeated.c_str());
      return 2;
    }
    if (error.get_exit_code() == 0) return app.exit(error);
    std::fprintf(stderr, "%s\n", common::refused_words(given_command(app).second, error.what()).c_str());
    return 2;
  } catch (const common::InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", app.get_name().c_str(), error.what());
    return 1;
  }
}

}  // namespace slewlab::tools
