// The equations that the reference integrates: where the parts of the machine stand in its state vector, and the rates of a state.
// Contacts stand as they are latched, so that the rates are smooth between two changes.
#pragma once

#include <array>
#include <vector>

#include "sim/integrate/reference.h"
#include "sim/model/load.h"

namespace slewlab::sim {

// State vector: motor angles and speeds less the held torque's share, q, v, load_q, load_v, extra states.
struct ReferenceEquations {
  ReferenceMachine machine;
  ReferenceExtra extra;
  int group_count = 0;  // that move for themselves: none where the drive is rigid
  int rigid_groups = 0; // that turn with the house
  int mode_count = 0;
  int load_count = 0;  // 2 or 0
  bool has_axis_force = false;
  int size = 0;
  double ratio = 1.0;
  std::vector<double> square;
  LoadOnSpring load;
  std::array<double, 2> load_square{}, load_damping{}, load_from_tip{}, load_from_tip_velocity{};

  // The held torque: angle and speed it has given each motor up to `held_since`. A rigid drive's acts on the house.
  GroupArray held{};  // [Nm] whole group, slew axis
  GroupArray held_angle{}, held_speed{};
  double held_since = 0.0;

  std::array<int, kMaximumGroupCount> contact{};  // -1, 0, +1: flank in contact

  std::vector<double> modal_force;  // room for an extra's forces

  int speeds() const { return group_count; }
  int q() const { return 2 * group_count; }
  int v() const { return q() + mode_count; }
  int load_q() const { return v() + mode_count; }
  int load_v() const { return load_q() + load_count; }
  int extra_start() const { return load_v() + load_count; }
};

// Throws std::invalid_argument for a machine that cannot be.
ReferenceEquations make_reference_equations(ReferenceMachine machine, ReferenceExtra extra);

// Where everything is at time t [s] in the state y, and how an extra has changed the gears. It points into y and itself.
struct ReferencePlace {
  ReferenceMotion seen;
  GroupArray motor_angle{}, motor_speed{}, gear_torque{};
  ReferenceGears gears;
};
void observe(const ReferenceEquations& r, double t, const double* y, ReferencePlace& motion);

// Of group i: its gears as an extra has them, and what they are deflected by.
GearContact gear_now(const ReferenceEquations& r, const ReferencePlace& motion, int i);
double deflection_of(const ReferenceEquations& r, const ReferencePlace& motion, int i);       // [rad]
double deflection_rate_of(const ReferenceEquations& r, const ReferencePlace& motion, int i);  // [rad/s]

// Depth and push of one flank, both > 0 in contact; the smaller one is the contact function.
double contact_function(const GearContact& gear, int side, double deflection, double rate);

// Torques of the gears with the contacts as they are latched: smooth between two contact changes. Returns their sum [Nm].
double fill_gear_torques(const ReferenceEquations& r, ReferencePlace& motion);

// Right-hand side; leaves the accelerations of the modes at rates[v()].
void derive(ReferenceEquations& r, double t, const double* y, double* rates);

}  // namespace slewlab::sim
