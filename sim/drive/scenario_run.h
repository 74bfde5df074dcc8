#pragma once

// What a scenario's file means for the parts of a run on the plant's side.

#include "sim/drive/drive_protection.h"
#include "sim/drive/lockstep_loop.h"
#include "sim/integrate/machine_settings.h"
#include "sim/drive/scenario_file.h"

namespace slewlab::sim {

// The machine of a file: its effects and its drive's protection with it. Throws common::InputError where an effect in the
// file is unknown or wrong.
MachineSettings machine_settings(const MachineFile& crane);
MachineSettings machine_settings(const Scenario& scenario);

// Of the configuration's run number 0 (msgs/run_identity.h), as drive_run().
LockstepSettings lockstep_settings(const Scenario& scenario);

DriveRun drive_run(const Scenario& scenario);

}  // namespace slewlab::sim
