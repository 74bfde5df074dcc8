// Reads `drive_protection:` of a machine's file (sim/drive/drive_protection_settings.h).
#pragma once

#include "common/unit.h"
#include "common/yaml_reader.h"
#include "sim/drive/drive_protection_settings.h"

namespace slewlab::sim {

// Units at the motor shaft: a motor that turns, or a linear one.
struct ShaftUnits {
  common::Unit torque = common::Unit::newton_metre;
  common::Unit torque_rate = common::Unit::newton_metre_per_second;
  common::Unit position = common::Unit::radian;
  common::Unit speed = common::Unit::radian_per_second;
};
inline constexpr ShaftUnits kLinearShaft{common::Unit::newton, common::Unit::newton_per_second, common::Unit::metre,
                                         common::Unit::metre_per_second};

DriveProtectionSettings read_drive_protection(common::YamlReader reader, const ShaftUnits& units);

}  // namespace slewlab::sim
