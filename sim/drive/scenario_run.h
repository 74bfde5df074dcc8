#pragma once

// What a scenario's file means for the parts of a run on the plant's side.

#include "sim/drive/drive_protection.h"
#include "sim/drive/lockstep_loop.h"
#include "sim/integrate/machine_settings.h"
#include "sim/drive/scenario_file.h"

namespace slewlab::sim {

// Throws common::InputError where an effect in the machine's file is unknown or wrong.
std::vector<common::EffectInstance> effects_of(const MachineFile& machine);
MachineSettings machine_settings(const Scenario& scenario);

LockstepSettings lockstep_settings(const Scenario& scenario);

DriveRun drive_run(const Scenario& scenario);

}  // namespace slewlab::sim
