// A machine out of a tree that was read already, from YAML (machine_file.h) or from anything else. Knows no YAML parser.
#pragma once

#include "common/input_error.h"
#include "common/yaml_node.h"
#include "sim/machine/machine_file.h"

namespace slewlab::sim {

// `problems` are those of reading the tree. Throws common::InputError with these and every problem found.
MachineFile machine_of(const common::YamlNode& root, common::InputProblems problems = {});

}  // namespace slewlab::sim
