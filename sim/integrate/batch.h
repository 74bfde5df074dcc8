// Machines of one topology side by side: the plant step of several machines at once, one machine per vector lane.
//
// Each machine's bits are those that it has alone under step() of plant.h: every lane does the same operations in the same order, and
// what a machine does not do (a gear without contact, no torque held on the house) is chosen away, not added as zero. What depends on
// the machine's own course is taken out of line: a machine is stepped by plant.h's step() where a contact may change within the step,
// where there is friction, and where a force acts along the boom. Torques on motors and house, and forces on tip, load and rod stay in
// line.
//
// Machines of one topology have the same number of groups and of modes, and all a load or none; values, steps and inputs are each
// machine's own. They are grouped by four or by eight; the last group is filled up with machines
// that nobody reads.
//
// For the columns of a fit (one machine with small changes along the same record): a batch of the columns' models, all inputs but the
// changed ones the same; set_state() once from the shared start, step_batch() and read_batch() at every step. What leads an observer (torques
// on motors and house, force on the tip) is PortForces of each machine's input. state_of() gives what an effect of a machine asks for.
//
// step_batch() and read_batch() allocate nothing, lock nothing, throw nothing.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "sim/integrate/plant.h"

namespace slewlab::sim {

// Four doubles by whatever the processor has, four by AVX2, eight by AVX-512. All give the same bits.
enum class BatchWidth { portable, four, eight };

bool is_supported(BatchWidth width);
// The widest that so many machines fill and the processor has.
BatchWidth usual_width(int machines);

struct PlantBatch;
struct FreePlantBatch {
  void operator()(PlantBatch* batch) const;
};
using PlantBatchHandle = std::unique_ptr<PlantBatch, FreePlantBatch>;

// At rest, as make_plant_state(). The models must outlive the batch. Throws std::invalid_argument where they are none, not of one
// topology, rigid (one inertia has no modes to put side by side) or luffing, or where the width is not supported here.
PlantBatchHandle make_plant_batch(const std::vector<const PlantModel*>& models, BatchWidth width);
PlantBatchHandle make_plant_batch(const std::vector<const PlantModel*>& models);  // of the usual width

int machine_count(const PlantBatch& batch);

// A machine's state into its lane and out of it. `state` has the room that make_plant_state() gave it.
void set_state(PlantBatch& batch, int machine, const PlantState& state);
void state_of(const PlantBatch& batch, int machine, PlantState& state);

// Advances every machine by its model's step; one input per machine.
void step_batch(PlantBatch& batch, const PlantInput* inputs);

// Steps of single machines that were taken out of line since the start.
std::int64_t steps_out_of_line(const PlantBatch& batch);

// What read() of plant.h gives for each machine, to the bit.
void read_batch(const PlantBatch& batch, PlantReadings* readings);

// What accelerations() of plant.h gives for each machine, and of its state all but `q` and `v`: what effects and sensors ask for.
void observe_batch(const PlantBatch& batch, PlantState* const* states, Accelerations* const* accelerations);

}  // namespace slewlab::sim
