#include "sim/machine/machine_file.h"

#include <utility>

#include "sim/machine/machine_tree.h"

namespace slewlab::sim {

MachineFile load_machine_file(const std::filesystem::path& file, const std::vector<common::Override>& overrides) {
  common::InputProblems problems;
  const common::YamlNode root = common::load_yaml_file(file, overrides, problems);
  try {
    return machine_of(root, std::move(problems));
  } catch (const common::InputError& error) {
    throw common::InputError(as_given(error.problems(), overrides));
  }
}

}  // namespace slewlab::sim
