// Reads a crane from YAML (config/cranes): the keys map one to one onto CraneParameters.
//
// `boom:` and `load:` may be absent: a machine without a boom, or without a load. Without `drive_protection:` the
// drive takes every finite torque and has no brakes. `effects:` is kept as it
// is for sim/effects.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/yaml_file.h"
#include "sim/drive/drive_protection_settings.h"
#include "sim/model/crane_parameters.h"

namespace slewlab::sim {

struct CraneFile {
  CraneParameters parameters;
  DriveProtectionSettings drive_protection;
  common::YamlNode effects;    // null where the file has none
  std::string canonical_text;  // for the configuration hash
};

// Throws common::InputError with every problem found.
CraneFile load_crane_file(const std::filesystem::path& file,
                          const std::vector<common::Override>& overrides = {});

}  // namespace slewlab::sim
