#pragma once

// A machine driven by the torque of a record, from the motion in which the record begins: forward simulation, nothing leads
// it back to the record. What differs at the end is the sum of all that the model lacks, so long runs drift; the report gives
// the difference over the whole and over tenths of the record.
//
// - TORQUE acts from the ENCODER it answers to the next one. Where a record lacks one, the last torque is held. It is
//   cut to the machine's own torque limit; brakes hold where TORQUE asks for them. Trips and delays of the drive are
//   not simulated: a record tells what the drive did.
// - Start: positions and speeds of the motors are the first ENCODER's. What the motors drive moves with them, boom and
//   load without swinging. A gear that gives stands in contact on the side its first torque pushes, wound up by what
//   accelerates its load; a load-side encoder's zero is unknown, so its reading begins where the record's does.

#include <cstdint>
#include <string>
#include <vector>

#include "msgs/run_log.h"
#include "sim/integrate/machine_settings.h"
#include "sim/machine/machine_file.h"

namespace slewlab::tools {

struct OpenLoopRun {
  msgs::RunLog run;                  // ENCODER and SENSORS simulated; TORQUE and OPERATOR the record's
  std::vector<std::string> remarks;  // what the record did not give, one line each
  double step = 0.0;                 // [s] of the plant: a whole number of them in each period of ENCODER
};

// `longest_step` [s] of the plant. Throws std::invalid_argument where the record is of another number of motor groups, has
// fewer than two ENCODER or no TORQUE, or the machine cannot be built; std::runtime_error where the motion is no longer finite.
OpenLoopRun simulate_open_loop(const sim::MachineFile& machine, const std::vector<common::EffectInstance>& effects,
                               const msgs::RunLog& record, double longest_step, std::int64_t configuration_hash);

}  // namespace slewlab::tools
