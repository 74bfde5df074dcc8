#include "sim/machine/machine_file.h"

#include "common/yaml_reader.h"
#include "sim/machine/axis_file.h"
#include "sim/machine/crane_file.h"

namespace slewlab::sim {
namespace {

void collect_spreads(const common::YamlNode& node, const std::string& path, std::map<std::string, double>& spreads) {
  for (const common::YamlEntry& entry : node.entries) {
    const std::string below = path.empty() ? entry.key : path + '.' + entry.key;
    const common::YamlNode* spread = entry.value.find("spread");
    if (spread != nullptr && entry.value.find("value") != nullptr) {
      if (const auto share = common::parse_share(*spread)) spreads[below] = *share;
    } else if (entry.key != "effects") {
      collect_spreads(entry.value, below, spreads);
    }
  }
}

}  // namespace

std::string_view name_of(MachineKind kind) { return kind == MachineKind::crane ? "crane" : "axis"; }

MachineFile load_machine_file(const std::filesystem::path& file, const std::vector<common::Override>& overrides) {
  common::InputProblems problems;
  const common::YamlNode root = common::load_yaml_file(file, overrides, problems);
  if (root.kind != common::YamlNode::Kind::map) throw common::InputError(as_given(problems, overrides));

  MachineFile result;
  common::YamlReader reader(root, "", problems);
  const common::YamlNode* kind = root.find("kind");
  if (kind != nullptr && kind->scalar == name_of(MachineKind::axis)) {
    result.kind = MachineKind::axis;
    read_axis(reader, result);
  } else if (kind == nullptr || kind->scalar == name_of(MachineKind::crane)) {
    read_crane(reader, result);
  } else {
    problems.push_back({kind->mark, "kind", common::excerpt(*kind), "crane or axis"});
    throw common::InputError(as_given(problems, overrides));
  }
  if (const common::YamlNode* effects = reader.raw("effects")) result.effects = *effects;
  reader.finish();
  if (!problems.empty()) throw common::InputError(as_given(problems, overrides));
  collect_spreads(root, "", result.spreads);
  result.canonical_text = common::canonical_text(root);
  return result;
}

}  // namespace slewlab::sim
