// A tree of YAML (yaml_node.h) written as a file again: with every `include:` and every value laid on top worked in, so that it stands alone.
#pragma once

#include <string>

#include "common/yaml_node.h"

namespace slewlab::common {

// Block style; reads back as the same tree. Comments are no part of a tree.
std::string yaml_text(const YamlNode& node);

}  // namespace slewlab::common
