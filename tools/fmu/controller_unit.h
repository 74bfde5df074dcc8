// The controller as an FMU holds it: plausibility and step as slewlab-controller computes them (controller/process/computed_answer.h).
// Inputs are what ENCODER and OPERATOR say, outputs what TORQUE and CONTROLLER_STATE say. One communication step is one period: it
// computes the answer to the inputs, which stands in the outputs behind it. Every communication step is the controller's period, a
// parameter [s]; another one is refused.
#pragma once

#include <memory>

#include "tools/fmu/unit.h"

namespace slewlab::tools::fmu {

// Throws common::InputError.
std::unique_ptr<Unit> make_controller_unit(const UnitFile& file);

}  // namespace slewlab::tools::fmu
