#pragma once

// The configuration of a run as files of its own: scenario.yaml, crane.yaml and controller.yaml with every include
// and every --set worked in, values with their units and sources. The run reads these copies, so what lies beside
// its log is what ran, and can run again.

#include <filesystem>
#include <vector>

#include "common/yaml_file.h"

namespace slewlab::tools {

// Writes the three files into `folder`; answers with the scenario's path. Throws common::InputError where the
// originals cannot be read, std::runtime_error where the copies cannot be written.
std::filesystem::path write_resolved_configuration(const std::filesystem::path& scenario,
                                                   const std::vector<common::Override>& overrides,
                                                   const std::filesystem::path& folder);

}  // namespace slewlab::tools
