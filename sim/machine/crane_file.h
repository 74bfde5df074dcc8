// Reads `kind: crane` (config/cranes): the keys map one to one onto CraneParameters. `boom:` and `load:` may be absent: a
// machine without a boom, or without a load.
#pragma once

#include "common/yaml_reader.h"
#include "sim/machine/machine_file.h"

namespace slewlab::sim {

// Of a file whose kind is a crane; problems go where the reader collects them.
void read_crane(common::YamlReader& reader, MachineFile& file);

}  // namespace slewlab::sim
