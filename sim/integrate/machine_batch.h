// Machines under one command side by side, each to the bit as step() of machine.h steps it alone: effects machine by machine, the plants of one
// topology in the lanes of a batch. For the columns of a fit: one machine with small changes along the same record.
//
// A machine alone in its topology, one of a rigid drive, one whose boom luffs, and machines that are mostly out of line
// (friction, a force along the boom) are stepped one by one. While machines are in lanes, the coordinates of their modes are there alone: of `state` all but `q` and `v` is that of
// the last step's end.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/integrate/batch.h"
#include "sim/integrate/machine.h"

namespace slewlab::sim {

// Machines of one topology.
struct MachineGroup {
  std::vector<Machine*> machines;
  PlantBatchHandle plants;  // none: one by one
  std::vector<PlantInput> inputs;
  std::vector<PlantState*> states;
  std::vector<Accelerations*> accelerations;
  std::int64_t steps = 0;
};

struct MachineBatch {
  std::vector<MachineGroup> groups;
};

// The machines must outlive the batch and stay where they are.
MachineBatch make_machine_batch(const std::vector<Machine*>& machines);

// Allocates nothing, throws nothing.
void step(MachineBatch& batch, const DriveCommand& command);

}  // namespace slewlab::sim
