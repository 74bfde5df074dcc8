// Reads the controller's settings from YAML (config/controllers).
#pragma once

#include <filesystem>
#include <vector>

#include "common/yaml_file.h"
#include "controller/controller.h"

namespace slewlab::controller {

struct ControllerFile {
  ControllerSettings settings;  // the period is the scenario's; here it keeps its default
  std::string canonical_text;   // for the configuration hash
};

// Throws common::InputError with every problem found.
ControllerFile load_controller_file(const std::filesystem::path& file,
                                    const std::vector<common::Override>& overrides = {});

}  // namespace slewlab::controller
