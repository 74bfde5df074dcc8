// The crane at a fixed step: exact modes, Hermite contact torque, contact changes found inside the step.
//
// State: motor groups (double integrators on the slew axis), the boom on its free house in modal coordinates,
// the load on its rope. One step of length h:
//
// - Every mode q'' + d q' + w^2 q = f(t) is advanced exactly for a force that is a cubic polynomial of time.
// - The gears' torque over the step is the cubic Hermite polynomial through its values T and rates T' at both
//   ends. The end values depend linearly on the end state, so they come from a 2x2 solve per group and one 2x2
//   solve for the house (all groups push on one house): linear cost in groups and in elements.
// - A change of contact (gear.h: teeth push, never pull) is located inside the step on the cubic Hermite
//   interpolant of the gear deflection; the step is split there. Splits are bounded (kMaximumSplits).
// - Rope force: linear in time over the step; the rope is a soft spring (load.h). The load's two modes are
//   advanced exactly for a tip that moves linearly between the step's ends.
// - Torques of the motors are held over the step; port forces of effects too. Friction on motors and house
//   (brake, dragging brake, slew bearing) is a torque that opposes motion up to a level and holds at rest: it
//   is found with the step's end speed, so that sticking is exact and nothing chatters: by sweeps over motors and
//   house, and by pivots (friction.h) where those do not settle.
//
// - A machine of one inertia (`drive.is_rigid`) is stepped as one inertia: constant acceleration between the moments
//   at which friction stops it, exactly, for torques held over the step.
// - What acts on the axis wherever it stands (AxisForceParameters) is held at its value in the middle of the step, angle
//   x + h v / 2: second order, and of an undamped pendulum the energy stays bounded (Verlet's scheme).
//
// Order of accuracy: the contact phases are of fourth order in h, the splits keep at least second order across
// impacts. step() allocates nothing, locks nothing, throws nothing. Same inputs, same bits.
//
// Source: thesis 3.6 for the equations; the scheme is this project's (docs/model.md derives it).
#pragma once

#include <vector>

#include "sim/integrate/plant_model.h"
#include "sim/integrate/plant_ports.h"
#include "sim/integrate/plant_state.h"

namespace slewlab::sim {

inline constexpr int kMaximumSplits = 16;  // contact changes inside one step before the rest runs unsplit

// Room that step() works in, sized once.
struct PlantWorkspace {
  ModalStep partial;
  std::vector<double> q, v;  // trial end state
};

PlantWorkspace make_plant_workspace(const PlantModel& model);

// Advances the state by model.step.
void step(const PlantModel& model, PlantWorkspace& workspace, const PlantInput& input, PlantState& state);

}  // namespace slewlab::sim
