// A controller's settings out of a tree that was read already, from YAML (controller_file.h) or from anything else. Knows no
// YAML parser.
#pragma once

#include "common/input_error.h"
#include "common/yaml_node.h"
#include "common/yaml_reader.h"
#include "controller/controller_file.h"

namespace slewlab::controller {

// The settings of an opened file, but for finish().
void read_controller(common::YamlReader& reader, ControllerSettings& settings);

// `problems` are those of reading the tree. Throws common::InputError with these and every problem found.
ControllerFile controller_of(const common::YamlNode& root, common::InputProblems problems = {});

}  // namespace slewlab::controller
