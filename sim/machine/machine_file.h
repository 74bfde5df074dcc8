// Reads a machine from YAML: a crane (crane_file.h) or a plain axis (axis_file.h), as its `kind:` says.
//
// Every number has the form {value, unit, source}; `spread: 10 %` beside them is one standard deviation of the number
// from unit to unit, relative (absent: kUnitDeviation of description.h). Without `drive_protection:` the drive takes every
// finite torque and has no brakes. `effects:` is kept as it is for sim/effects.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/yaml_file.h"
#include "sim/drive/drive_protection_settings.h"
#include "sim/model/crane_parameters.h"

namespace slewlab::sim {

enum class MachineKind { crane, axis };

// "crane", "axis": as the file's `kind:` and the scenario's key have it.
std::string_view name_of(MachineKind kind);

// What a plain axis is beside its numbers.
struct AxisForm {
  bool is_linear = false;        // [m], [kg], [N] on the axis in place of [rad], [kg m^2], [Nm]
  bool is_shaft_linear = false;  // no turning motor: encoder and command are those of the carriage, [m] and [N]
};

struct MachineFile {
  MachineKind kind = MachineKind::crane;
  AxisForm axis;  // of kind axis
  CraneParameters parameters;
  DriveProtectionSettings drive_protection;
  common::YamlNode effects;               // null where the file has none
  std::map<std::string, double> spreads;  // [-] by "section.key", where the file gives one
  std::string canonical_text;             // for the configuration hash
};

// Throws common::InputError with every problem found.
MachineFile load_machine_file(const std::filesystem::path& file, const std::vector<common::Override>& overrides = {});

}  // namespace slewlab::sim
