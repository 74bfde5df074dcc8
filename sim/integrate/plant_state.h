// Where the plant stands between two steps, and what is read off it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sim/integrate/plant_model.h"
#include "sim/integrate/plant_ports.h"

namespace slewlab::sim {

struct PlantState {
  std::int64_t step_count = 0;  // the time is step_count * model.step
  GroupArray motor_angle{};     // [rad] slew axis
  GroupArray motor_speed{};     // [rad/s] slew axis
  std::vector<double> q, v;     // modal coordinates of boom and house [m sqrt(kg)], and their rates
  std::array<double, 2> load_q{}, load_v{};  // modal coordinates of the load

  // Derived from the above at the end of each step; kept because the next step starts with them.
  std::array<int, kMaximumGroupCount> contact{};  // -1, 0, +1: flank in contact
  GroupArray gear_torque{};        // [Nm] on the house
  double house_angle = 0.0;        // [rad]
  double house_speed = 0.0;        // [rad/s]
  double modal_house_acceleration = 0.0;  // [rad/s^2] share of the modes, without torques and forces
  double tip_displacement = 0.0;   // [m]
  double tip_velocity = 0.0;       // [m/s]
  double rope_force = 0.0;         // [N] on the tip
  double rope_force_rate = 0.0;    // [N/s]
  double rope_damping_force = 0.0; // [N] share of rope_force
  double other_house_torque = 0.0; // [Nm] friction and ports on the house during the last step
  double other_tip_force = 0.0;    // [N] ports on the tip during the last step
  double other_uniform_force = 0.0;
  double luffing_force = 0.0;      // [1/s^2] of the port `luffing` during the last step
  GroupArray motor_friction{};     // [Nm] on each group during the last step, slew axis
  double house_friction = 0.0;     // [Nm] on the house during the last step

  std::array<std::int64_t, kMaximumGroupCount> play_crossings{};  // changes of the flank since the start
  std::array<int, kMaximumGroupCount> last_flank{};               // -1 or +1; 0 before the first contact
  std::int64_t contact_changes = 0;                               // contacts made or lost since the start
  std::int64_t unsplit_steps = 0;  // steps in which kMaximumSplits was reached
  std::int64_t unsolved_frictions = 0;  // steps, or parts of one, whose frictions do not hold to their law (friction.h)
  double supplied_work = 0.0;      // [J] by motors, friction and ports since the start
};

// At rest, gears in the middle of their play, load hanging straight.
PlantState make_plant_state(const PlantModel& model);

// Recomputes what a state derives from its angles, speeds and modes: call it after setting those by hand. Where the
// drive is rigid, the motors' angles and speeds are derived, too.
void refresh(const PlantModel& model, PlantState& state);

// Of a whole step from this state: of the gears that are in contact then.
GearSystem gear_system(const PlantModel& model, const PlantState& state);

// At the end of the last step, with what acted then.
Accelerations accelerations(const PlantModel& model, const PlantState& state);

PlantReadings read(const PlantModel& model, const PlantState& state);
// The same where the accelerations are known.
PlantReadings read(const PlantModel& model, const PlantState& state, const Accelerations& acceleration);

// beta_1, beta_2 [rad].
double rope_angle(const PlantModel& model, const PlantState& state);
double rod_angle(const PlantModel& model, const PlantState& state);

// [rad] motor minus house, play included; positive when the motor leads.
double gear_deflection(const PlantState& state, int group);

// [N] mean shear force of each element, written to `shear` (element_count values).
void shear_forces(const PlantModel& model, const PlantState& state, double* shear);

// [J] of mode k, and of the whole crane: kinetic, elastic (boom, gears, rope) and gravitational.
double modal_energy(const PlantModel& model, const PlantState& state, int mode);
double mechanical_energy(const PlantModel& model, const PlantState& state);

// The rope's force on the tip and its rate. The damping's share of the rate is its change over the last
// `length` seconds; with 0 it counts as steady.
[[gnu::always_inline]] inline void rope_forces(const PlantModel& model, double length, PlantState& state) {
  if (!model.has_load) return;
  const LoadOnSpring& load = model.load;
  const double y = load.modes(0, 0) * state.load_q[0] + load.modes(0, 1) * state.load_q[1];
  const double y_rate = load.modes(0, 0) * state.load_v[0] + load.modes(0, 1) * state.load_v[1];
  const double rod_rate = load.modes(1, 0) * state.load_v[0] + load.modes(1, 1) * state.load_v[1];
  const double damping = load.damping(0, 0) * (y_rate - state.tip_velocity) + load.damping(0, 1) * rod_rate;
  state.rope_force_rate = load.rope_stiffness * (y_rate - state.tip_velocity);
  if (length > 0.0) state.rope_force_rate += (damping - state.rope_damping_force) / length;
  state.rope_damping_force = damping;
  state.rope_force = load.rope_stiffness * (y - state.tip_displacement) + damping;
}

}  // namespace slewlab::sim
