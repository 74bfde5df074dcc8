// Reads `sensors:` of a machine's file: the noise of its sensors and the gains of its accelerometers, where they are known. Every key may be left out and is an ordinary
// sensor's then (description.h), of gain 1.
#pragma once

#include "common/yaml_reader.h"
#include "sim/model/crane_parameters.h"

namespace slewlab::sim {

SensorParameters read_crane_sensors(common::YamlReader reader);
// A plain axis has no accelerometers; `load_position_noise` is of its second encoder.
SensorParameters read_axis_sensors(common::YamlReader reader, bool is_linear, bool is_shaft_linear);

}  // namespace slewlab::sim
