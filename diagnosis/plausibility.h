// Whether signals that physics ties to each other agree. A wrong sign, unit or axis is refused and named with the one that would fit;
// factors below 3 are left to the diagnosis, because a crane may have them.
#pragma once

#include "diagnosis/record.h"
#include "diagnosis/shadow.h"
#include "sim/integrate/machine_settings.h"

namespace slewlab::diagnosis {

// Positions that jump; speeds against the rates of their positions; accelerations, slowly, against the motors' at the sensor's radius; torques
// against the rated one. Throws NotAdmitted.
void check_units(const Record& record, const AdmissionSettings& settings);

// The groups against each other: all turn one house, none against the first. Throws NotAdmitted.
void check_groups(const Record& record, const sim::CraneParameters& nominal);

// Torques against what the nominal crane, following the record, needs for the same motion: what its drive makes of the recorded ones
// + missing (shadow.h), mean of the groups, slower than the structure. Refuses a factor above 3 or below 1/3 between two that go
// together, a turned sign, of all or of one group, groups that are exchanged, and a command that stands still for `frozen_time` while the need changes by a seventh of its range (half of
// it where one group alone stands), once: to a level, of either sign, a controller comes back. Throws NotAdmitted.
void check_torques(const Record& record, const Shadow& follower, const sim::MachineSettings& nominal, const AdmissionSettings& settings);

}  // namespace slewlab::diagnosis
