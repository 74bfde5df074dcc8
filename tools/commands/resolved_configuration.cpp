#include "tools/commands/resolved_configuration.h"

#include <string_view>

#include "common/yaml_text.h"
#include "sim/drive/scenario_file.h"
#include "tools/commands/whole_file.h"

namespace slewlab::tools {
namespace {

using common::InputError;
using common::InputProblems;
using common::Override;
using common::YamlNode;

YamlNode load(const std::filesystem::path& file, const std::vector<Override>& overrides) {
  InputProblems problems;
  YamlNode node = common::load_yaml_file(file, overrides, problems);
  if (!problems.empty()) throw InputError(problems);
  return node;
}

void set_reference(YamlNode& root, std::string_view key, const char* file) {
  YamlNode* node = root.find(key);
  if (node == nullptr) return;
  node->scalar = file;
  node->quoted = false;
}

}  // namespace

std::filesystem::path write_resolved_configuration(const std::filesystem::path& scenario_path,
                                                   const std::vector<Override>& overrides,
                                                   const std::filesystem::path& folder) {
  const sim::Scenario scenario = sim::load_scenario_file(scenario_path, overrides);
  std::vector<Override> own = overrides;
  for (const char* way : {"crane.", "axis.", "controller."}) common::take_overrides(way, own);  // laid over files of their own
  YamlNode root = load(scenario_path, own);
  const YamlNode crane = load(scenario.crane_file, scenario.crane_overrides);
  const YamlNode controller = load(scenario.controller_file, scenario.controller_overrides);
  const std::string machine = std::string(sim::name_of(scenario.crane.kind));
  set_reference(root, machine, (machine + ".yaml").c_str());
  set_reference(root, "controller", "controller.yaml");
  write_whole_file(folder / (machine + ".yaml"), common::yaml_text(crane));
  write_whole_file(folder / "controller.yaml", common::yaml_text(controller));
  write_whole_file(folder / "scenario.yaml", common::yaml_text(root));
  return folder / "scenario.yaml";
}

}  // namespace slewlab::tools
