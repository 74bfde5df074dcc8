#include "tools/commands/check_command.h"

#include <algorithm>
#include <optional>
#include <ostream>
#include <stdexcept>
#include <string>

#include "common/effect.h"
#include "common/yaml_reader.h"
#include "controller/controller_file.h"
#include "sim/drive/scenario_file.h"
#include "sim/effects/catalogue.h"
#include "sim/integrate/machine.h"
#include "sim/machine/crane_file.h"

namespace slewlab::tools {
namespace {

using common::InputError;
using common::InputProblems;
using common::YamlNode;

// Where the scenario names its controller, for problems that lie between two files.
common::SourceMark mark_of(const std::filesystem::path& file, const std::vector<common::Override>& overrides,
                           std::string_view key) {
  InputProblems ignored;
  const YamlNode root = common::load_yaml_file(file, overrides, ignored);
  const YamlNode* node = root.find(key);
  return node == nullptr ? root.mark : node->mark;
}

// What a run would refuse of the crane's effects, said where the user wrote them.
std::vector<common::EffectInstance> check_effects(const sim::CraneFile& crane, InputProblems& problems) {
  return common::read_effects(crane.effects, sim::effect_abouts(), problems);
}

// Whether parameters that are good one by one make a machine; a boom of so many elements takes milliseconds to assemble.
void check_machine(const sim::CraneFile& crane, double plant_step, const std::filesystem::path& file, InputProblems& problems) {
  constexpr int kMostElements = 64;
  const std::vector<common::EffectInstance> effects = check_effects(crane, problems);
  if (!problems.empty() || crane.parameters.boom.element_count > kMostElements) return;
  try {
    sim::make_machine({.crane = crane.parameters, .effects = effects, .step = plant_step});
  } catch (const std::invalid_argument& error) {
    const bool by_effect = !effects.empty();
    problems.push_back({by_effect ? crane.effects.mark : common::SourceMark{file.string(), 0, 0}, by_effect ? "effects" : "",
                        std::string("a machine that cannot be built (") + error.what() + ")", "values that fit each other"});
  }
}

void check_crane(const std::filesystem::path& file, const std::vector<common::Override>& overrides, InputProblems& problems) {
  const double plant_step = sim::MachineSettings{}.step;
  check_machine(sim::load_crane_file(file, overrides), plant_step, file, problems);
}

void check_scenario(const std::filesystem::path& file, const std::vector<common::Override>& overrides, ControllerBy by,
                    InputProblems& problems) {
  const sim::Scenario scenario = sim::read_scenario_file(file, overrides, problems);
  const bool whole = problems.empty();
  if (whole) {
    check_machine(scenario.crane, static_cast<double>(scenario.plant_step) * 1e-9, scenario.crane_file, problems);
  } else {
    check_effects(scenario.crane, problems);
  }
  if (by == ControllerBy::user || scenario.controller_file.empty()) return;
  try {
    const controller::ControllerSettings settings =
        controller::load_controller_file(scenario.controller_file, scenario.controller_overrides).settings;
    const int crane_groups = scenario.crane.parameters.drive.group_count;
    if (whole && settings.group_count != crane_groups) {
      problems.push_back({mark_of(file, overrides, "controller"), "controller",
                          "a controller for " + std::to_string(settings.group_count) + " motor group(s)",
                          "one for the crane's " + std::to_string(crane_groups)});
    }
  } catch (const InputError& error) {
    problems.insert(problems.end(), error.problems().begin(), error.problems().end());
  }
}

// The node below `kind:`; nothing after a problem.
std::optional<YamlNode> kind_of(const std::filesystem::path& file, InputProblems& problems) {
  const YamlNode root = common::load_yaml_file(file, {}, problems);
  if (const YamlNode* kind = root.find("kind")) return *kind;
  if (problems.empty()) {
    problems.push_back({root.mark, "kind", "nothing: the key is missing", "crane, controller or scenario"});
  }
  return std::nullopt;
}

}  // namespace

InputProblems problems_in(const std::filesystem::path& file, const std::vector<common::Override>& overrides,
                          ControllerBy by) {
  InputProblems problems;
  const std::optional<YamlNode> kind = kind_of(file, problems);
  if (!kind) return problems;
  problems.clear();
  try {
    if (kind->scalar == "crane") {
      check_crane(file, overrides, problems);
    } else if (kind->scalar == "controller") {
      controller::load_controller_file(file, overrides);
    } else if (kind->scalar == "scenario") {
      check_scenario(file, overrides, by, problems);
    } else {
      problems.push_back({kind->mark, "kind", common::excerpt(*kind), "crane, controller or scenario"});
    }
  } catch (const InputError& error) {
    problems = error.problems();
  }
  return problems;
}

void complain(const InputProblems& problems, std::ostream& complaints) {
  constexpr std::size_t kMost = 100;  // nobody reads on; the first ones are told
  for (std::size_t i = 0; i < std::min(kMost, problems.size()); ++i) complaints << common::to_text(problems[i]) << '\n';
  if (problems.size() > kMost) complaints << "and " << problems.size() - kMost << " more problems\n";
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
    complain(problems, complaints);
  }
  return exit_code;
}

}  // namespace slewlab::tools
