#include "tools/commands/check_command.h"

#include <algorithm>
#include <ostream>
#include <string>

#include "common/yaml_reader.h"
#include "controller/controller_file.h"
#include "sim/machine/machine_file.h"
#include "sim/drive/scenario_file.h"

namespace slewlab::tools {
namespace {

using common::InputError;
using common::InputProblems;
using common::YamlNode;

constexpr const char* kKinds = "crane, axis, controller or scenario";

// Where the scenario names its controller, for problems that lie between two files.
common::SourceMark mark_of(const std::filesystem::path& file, const std::vector<common::Override>& overrides,
                           std::string_view key) {
  InputProblems ignored;
  const YamlNode root = common::load_yaml_file(file, overrides, ignored);
  const YamlNode* node = root.find(key);
  return node == nullptr ? root.mark : node->mark;
}

void check_scenario(const std::filesystem::path& file, const std::vector<common::Override>& overrides,
                    InputProblems& problems) {
  const sim::Scenario scenario = sim::read_scenario_file(file, overrides, problems);
  const bool whole = problems.empty();
  if (scenario.controller_file.empty()) return;
  try {
    const controller::ControllerSettings settings =
        controller::load_controller_file(scenario.controller_file, scenario.controller_overrides).settings;
    const int crane_groups = scenario.crane.parameters.drive.group_count;
    if (whole && settings.group_count != crane_groups) {
      problems.push_back({mark_of(file, overrides, "controller"), "controller",
                          "a controller for " + std::to_string(settings.group_count) + " motor group(s)",
                          "one for the " + std::to_string(crane_groups) + " of the " + std::string(sim::name_of(scenario.crane.kind))});
    }
  } catch (const InputError& error) {
    problems.insert(problems.end(), error.problems().begin(), error.problems().end());
  }
}

}  // namespace

InputProblems problems_in(const std::filesystem::path& file, const std::vector<common::Override>& overrides) {
  InputProblems problems;
  const YamlNode root = common::load_yaml_file(file, {}, problems);
  const YamlNode* kind = root.find("kind");
  if (kind == nullptr) {
    if (problems.empty()) {
      problems.push_back({root.mark, "kind", "nothing: the key is missing", kKinds});
    }
    return problems;
  }
  problems.clear();
  try {
    if (kind->scalar == "crane" || kind->scalar == "axis") {
      sim::load_machine_file(file, overrides);
    } else if (kind->scalar == "controller") {
      controller::load_controller_file(file, overrides);
    } else if (kind->scalar == "scenario") {
      check_scenario(file, overrides, problems);
    } else {
      problems.push_back({kind->mark, "kind", common::excerpt(*kind), kKinds});
    }
  } catch (const InputError& error) {
    problems = error.problems();
  }
  return problems;
}

int check_files(const std::vector<std::filesystem::path>& files,
                const std::vector<common::Override>& overrides, std::ostream& out, std::ostream& complaints) {
  int exit_code = 0;
  for (const std::filesystem::path& file : files) {
    const InputProblems problems = problems_in(file, overrides);
    if (problems.empty()) {
      out << file.string() << ": OK\n";
      continue;
    }
    exit_code = 1;
    for (const common::InputProblem& problem : problems) complaints << common::to_text(problem) << '\n';
  }
  return exit_code;
}

}  // namespace slewlab::tools
