// The whole step of a machine that is one inertia (`drive.is_rigid`), exact for torques held over it. Friction has its full level against
// the motion, and at rest takes what holds it there, up to the level: at most two pieces, one until it stops and one from then on.
#pragma once

#include "sim/integrate/plant_state.h"

namespace slewlab::sim {

void step_rigid(const PlantModel& model, const Push& push, PlantState& state);

}  // namespace slewlab::sim
