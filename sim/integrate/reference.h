// The judge of accuracy: the crane integrated by SUNDIALS at a tight tolerance, with root finding at every
// contact change and a restart there.
//
// Same physics as the plant (model/): motor groups on the slew axis, gears that push and never pull
// (contact_torque, gear.h), the boom on its free house in all its modes, the load on its rope (load.h). The
// torque of the motors is held between the calls of advance(). Nothing of the fixed step is used.
//
// - kBdf: CVODE, variable order BDF. The judge.
// - kDirk: ARKODE, a singly diagonal implicit Runge-Kutta method of fifth order: a second opinion by a method of
//   another kind. One-step, so contact changes cost it no order; the cheaper one at 1e-11 and below.
//
// A contact counts as closed while min(depth, depth + c/k rate) > 0, which is contact_torque() != 0; these are
// the functions whose roots are found. The held torque's share of each motor's motion is written in closed
// form, so that the right-hand side stays continuous where the torque jumps. Newton's systems are solved
// exactly, at a cost linear in the modes: damped oscillators, coupled by few forces.
//
// Tolerances are absolute, in speed: `tolerance` times the motion of the machine at a fifth of its top speed.
//
// Truth machines: ReferenceMachine lets every group, gear and mode differ; ReferenceExtra adds forces with states
// of their own, or changes the gears. Errors: std::invalid_argument for a machine or a time that cannot be,
// std::runtime_error with SUNDIALS' word where the integration fails.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "sim/integrate/plant.h"

namespace slewlab::sim {

// What the reference integrates. reference_machine() gives the crane as the plant sees it.
struct ReferenceMachine {
  CraneParameters crane;                             // geometry, ratios, load; modes and gears stand below
  GroupArray group_inertia{};                        // [kg m^2] per group, slew axis
  std::array<GearContact, kMaximumGroupCount> gear;  // per group, slew axis
  FreeHouseModes modes;
};
ReferenceMachine reference_machine(const CraneParameters& crane);

// What an extra sees. Arrays have one entry per group or mode.
struct ReferenceMotion {
  double time = 0.0;                     // [s]
  const double* motor_torque = nullptr;  // [Nm] held, whole group, slew axis
  const double* motor_angle = nullptr;   // [rad] slew axis
  const double* motor_speed = nullptr;   // [rad/s]
  const double* gear_torque = nullptr;   // [Nm] on the house; not yet known (0) where the gears are asked for
  double house_angle = 0.0;              // [rad]
  double house_speed = 0.0;              // [rad/s]
  double tip_displacement = 0.0;         // [m]
  double tip_velocity = 0.0;             // [m/s]
  double rope_end_displacement = 0.0;    // [m] lower end of the rope, in space
  double rope_end_velocity = 0.0;        // [m/s]
  double rod_angle = 0.0;                // [rad]
  double rod_rate = 0.0;                 // [rad/s]
  const double* q = nullptr;             // modal coordinates of boom and house
  const double* v = nullptr;
};

// Forces that an extra adds; they come in as zero.
struct ReferenceForces {
  GroupArray motor_torque{};      // [Nm] on each group, slew axis
  double house_torque = 0.0;      // [Nm]
  double tip_force = 0.0;         // [N] lateral
  double uniform_force = 0.0;     // [N/m] lateral, evenly along the boom
  double load_force = 0.0;        // [N] on the lower end of the rope
  double rod_moment = 0.0;        // [Nm]
  double* modal_force = nullptr;  // on each mode: any other force on house and boom, as shape times force
};

// How an extra changes the gears; comes in as no change.
struct ReferenceGears {
  GroupArray stiffness_share{};  // of the group's stiffness; 1
  GroupArray offset{};           // [rad] added to the gear deflection (transmission error)
  GroupArray offset_rate{};      // [rad/s]
};

// The Jacobian knows nothing of an extra: a law with rates far above 1e4 1/s makes the steps short, not wrong.
struct ReferenceExtra {
  std::vector<double> start;  // values of its states at time 0
  std::vector<double> scale;  // of each state: its error is held to tolerance times this
  // Both may be empty. `rates` has one entry per state.
  std::function<void(const ReferenceMotion&, const double* states, ReferenceForces&, double* rates)> forces;
  std::function<void(const ReferenceMotion&, const double* states, ReferenceGears&)> gears;
};

enum class ReferenceMethod { kBdf, kDirk };

struct ReferenceOptions {
  ReferenceMethod method = ReferenceMethod::kBdf;
  double tolerance = 1e-9;  // share of the machine's motion at a fifth of its top speed
  int order = 5;            // of kDirk: 2 ... 5; a low one is enough, and cheaper, where steps are short anyway
};

struct ReferenceCounts {
  std::int64_t steps = 0;
  std::int64_t evaluations = 0;      // of the right-hand side
  std::int64_t restarts = 0;         // at contact changes and, with an extra, at jumps of the torque
  std::int64_t contact_changes = 0;
  std::int64_t late_changes = 0;     // contacts that changed twice within one step and were put right at its end
};

struct Reference;
struct ReferenceDeleter {
  void operator()(Reference* reference) const;
};
using ReferencePointer = std::unique_ptr<Reference, ReferenceDeleter>;

// At rest at time 0, gears in the middle of their play.
ReferencePointer make_reference(const CraneParameters& crane, const ReferenceOptions& options = {});
ReferencePointer make_reference(ReferenceMachine machine, const ReferenceOptions& options,
                                ReferenceExtra extra = {});

// Takes over a state of the plant of the same crane at `time` [s]; an extra keeps its states.
void set_state(Reference& reference, const PlantState& state, double time);

// At rest, before anything moves: the load goes where it hangs still under the forces of the extra (an inclined crane's
// gravity, wind), the crane held where it stands. Throws std::runtime_error where it finds no such place.
void hang_load(Reference& reference);

// Integrates to `until` [s] with the torque [Nm] per motor of each group, on the fast axis.
void advance(Reference& reference, const GroupArray& motor_torque, double until);

double time(const Reference& reference);                         // [s]
PlantReadings read(const Reference& reference);                  // accelerations with the torque held last
GroupArray gear_torques(const Reference& reference);             // [Nm] on the house
double gear_deflection(const Reference& reference, int group);   // [rad] play included
std::array<std::int64_t, kMaximumGroupCount> play_crossings(const Reference& reference);
double rope_angle(const Reference& reference);                   // [rad] beta_1
double rod_angle(const Reference& reference);                    // [rad] beta_2
double tip_displacement(const Reference& reference);             // [m]
void shear_forces(const Reference& reference, double* shear);    // [N] per element
double mechanical_energy(const Reference& reference);            // [J] as plant.h
const double* extra_states(const Reference& reference);
const double* modal_coordinates(const Reference& reference);                   // q, one per mode
void modal_accelerations(const Reference& reference, double* acceleration);  // q'', with the torque held last
ReferenceCounts counts(const Reference& reference);

}  // namespace slewlab::sim
