#include "sim/integrate/machine_batch.h"

#include <algorithm>

namespace slewlab::sim {

namespace {

constexpr std::size_t kFewest = 3;           // machines side by side: two take as long as one after the other
constexpr std::int64_t kStepsToJudge = 256;  // after which it is asked whether they are mostly out of line
constexpr std::int64_t kMostlyOut = 4;       // a step out of line costs more than one in the lanes saves where one of so many is out

// A boom that luffs has other modes from stretch to stretch, which no lane takes over.
bool are_alike(const PlantModel& a, const PlantModel& b) {
  if (!a.luffing.empty() || !b.luffing.empty()) return false;
  return !a.is_rigid && !b.is_rigid && a.group_count == b.group_count && a.mode_count == b.mode_count && a.has_load == b.has_load;
}

void put_into_lanes(MachineGroup& group) {
  std::vector<const PlantModel*> models;
  for (Machine* const machine : group.machines) {
    models.push_back(&machine->model);
    group.states.push_back(&machine->state);
    group.accelerations.push_back(&machine->acceleration);
  }
  group.plants = make_plant_batch(models);
  group.inputs.resize(models.size());
  for (std::size_t m = 0; m < models.size(); ++m) set_state(*group.plants, static_cast<int>(m), group.machines[m]->state);
}

void take_out_of_lanes(MachineGroup& group) {
  for (std::size_t m = 0; m < group.machines.size(); ++m) state_of(*group.plants, static_cast<int>(m), group.machines[m]->state);
  group.plants.reset();
}

void step(MachineGroup& group, const DriveCommand& command) {
  if (!group.plants) {
    for (Machine* const machine : group.machines) step(*machine, command);
    return;
  }
  for (std::size_t m = 0; m < group.machines.size(); ++m) begin_step(*group.machines[m], command, group.inputs[m]);
  step_batch(*group.plants, group.inputs.data());
  observe_batch(*group.plants, group.states.data(), group.accelerations.data());
  for (Machine* const machine : group.machines) {
    machine->has_acceleration = true;
    end_step(*machine);
  }
  ++group.steps;
  const auto count = static_cast<std::int64_t>(group.machines.size());
  if (group.steps % kStepsToJudge == 0 && kMostlyOut * steps_out_of_line(*group.plants) > count * group.steps) take_out_of_lanes(group);
}

}  // namespace

MachineBatch make_machine_batch(const std::vector<Machine*>& machines) {
  MachineBatch batch;
  for (Machine* const machine : machines) {
    const auto with = std::find_if(batch.groups.begin(), batch.groups.end(),
                                   [&](const MachineGroup& group) { return are_alike(group.machines.front()->model, machine->model); });
    MachineGroup& group = with != batch.groups.end() ? *with : batch.groups.emplace_back();
    group.machines.push_back(machine);
  }
  for (MachineGroup& group : batch.groups) {
    if (group.machines.size() >= kFewest) put_into_lanes(group);
  }
  return batch;
}

void step(MachineBatch& batch, const DriveCommand& command) {
  for (MachineGroup& group : batch.groups) step(group, command);
}

}  // namespace slewlab::sim
