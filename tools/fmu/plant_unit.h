// The plant as an FMU holds it: the machine behind its drive (sim/drive/crane_plant.h), as slewlab-plant steps it. Inputs are what TORQUE
// says, outputs what ENCODER, SENSORS, TRUTH and PLANT_STATUS say. One communication step is one period of the wire: what the inputs
// say is one fresh answer of the controller, with an alive counter that advances, and it holds over the step.
//
// Of SENSORS there are those that the machine has places for. Parameters: plant_step [s], of which every communication step is a
// whole multiple, and seed.
#pragma once

#include <memory>

#include "tools/fmu/unit.h"

namespace slewlab::tools::fmu {

// Throws common::InputError, std::invalid_argument where the machine cannot be built.
std::unique_ptr<Unit> make_plant_unit(const UnitFile& file);

}  // namespace slewlab::tools::fmu
