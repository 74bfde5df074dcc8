// Reads the controller's settings from YAML (config/controllers).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
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

// What `to` has otherwise than `from`, as YAML to be laid over from's file by `include:`; empty where nothing differs. `source` is written
// beside every value. Groups, ratio and the shape of ramp and map are taken to be the same.
std::string changes_text(const ControllerSettings& from, const ControllerSettings& to, std::string_view source);

}  // namespace slewlab::controller
