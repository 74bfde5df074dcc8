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

#include <array>
#include <cstdint>
#include <vector>

#include "sim/integrate/modal_pass.h"
#include "sim/integrate/plant_ports.h"
#include "sim/model/crane.h"

namespace slewlab::sim {

inline constexpr int kMaximumSplits = 16;  // contact changes inside one step before the rest runs unsplit

// How one group's end torque and its rate answer the step: [T; T'] = inverse * (free values minus the house's).
struct GearStep {
  double inverse[2][2] = {};
  double answer[2][3] = {};  // to the house's angle, speed, acceleration
  double reciprocal_inertia = 0.0;  // [1/(kg m^2)]
};

// The 2x2 system for the sum of the gears' end torques and its rate, which depends on the step's length and on which gears are in contact.
struct GearSystem {
  std::array<std::array<double, 3>, 2> answer;  // of all gears in contact to the house's angle, speed, acceleration
  std::array<std::array<double, 2>, 2> system;
  double scale;  // 1 / determinant
};
inline constexpr int kTabulatedGroups = 4;  // up to so many, the whole step's systems are worked out beforehand

// Responses of every mode to the step's start state, to contact torque on the house and to force at the tip, in the blocks of
// modal_pass.h.
struct ModalStep {
  std::vector<double> free, end, held;
  std::vector<double> luffing_q, luffing_v;  // of every mode to the port `luffing`; empty where the boom does not luff
  // House rotation, speed and acceleration (rows) at the step's end, for T and T' at the end (columns).
  double house[3][2] = {};
  // House rotation, speed and acceleration at the end for a torque held on the house.
  double house_angle_to_torque = 0.0, house_speed_to_torque = 0.0, house_acceleration_to_torque = 0.0;
  double house_to_luffing[3] = {};  // rotation, speed, acceleration
  std::array<GearStep, kMaximumGroupCount> gear;
  std::vector<GearSystem> systems;  // by the gears in contact, group i's being bit i; empty: worked out in the step
  double length = 0.0;  // [s]
};

// How the load's modes answer a tip that moves linearly over the step.
struct LoadStep {
  double qq[2], qv[2], vq[2], vv[2];
  double q_in[2][4], v_in[2][4];  // to tip displacement at start, end; tip velocity at start, end
  double q_force[2], v_force[2];  // to a held modal force
};

// Constant for one crane and one step length.
struct PlantModel {
  CraneParameters parameters;
  double step = 0.0;  // [s]
  int group_count = 0;
  int mode_count = 0;    // modes of the boom on its free house
  int padded_count = 0;  // the same rounded up to whole blocks
  double ratio = 1.0;    // motor turns per turn of the crane
  std::array<GearContact, kMaximumGroupCount> gear;  // per group, slew axis
  GroupArray group_inertia{};                        // [kg m^2] per group, slew axis
  FreeHouseModes modes;
  // Rows that give the house's acceleration from the modal state, and its share per force.
  std::vector<double> house, pivot, tip, middle;                 // padded shapes; tip: where the rope hangs
  std::vector<double> tip_sensor;  // padded shape of the boom's own tip, where the accelerometer is: a jib reaches beyond
  std::vector<double> square, damping_rate, fastest;      // padded w^2 and d, and the faster of w and d
  std::vector<double> house_acceleration_q, house_acceleration_v;
  std::vector<double> shapes, sensed;  // those that the passes over the modes read, in their blocks
  std::vector<double> places;          // the same, mode by mode
  const ModalPasses* passes = nullptr;
  std::vector<double> uniform;
  std::vector<double> luffing;  // padded force on each mode per unit of the port `luffing`; empty where the boom does not luff
  Accelerations per_luffing;    // per unit of that port
  double house_per_house_torque = 0.0;  // [1/(kg m^2)] sum house^2
  double house_per_tip_force = 0.0;     // [1/(kg m)] sum house tip
  double house_per_uniform_force = 0.0; // [1/kg] sum house uniform
  LoadOnSpring load;
  // Of the load's two modes: w^2 and d, the faster of w and d, and how they answer the damping of the rope.
  std::array<double, kLanes> load_square{}, load_decay{}, load_fastest{}, load_damping_in{};
  bool has_load = false;
  bool has_axis_force = false;
  bool is_rigid = false;
  double rigid_inertia = 0.0;  // [kg m^2] of everything, where the drive is rigid
  ModalStep full;  // for the whole step
  LoadStep load_step;
};

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

// Room that step() works in, sized once.
struct PlantWorkspace {
  ModalStep partial;
  std::vector<double> q, v;  // trial end state
};

// Throws CannotBeBuilt for a machine without inertia or stiffness, or a rigid drive with a boom that bends or a load;
// std::invalid_argument for no groups or a step <= 0.
PlantModel make_plant_model(const CraneParameters& crane, double step);
// As make_plant_model, with each group's inertia and gears given (uneven drives).
PlantModel make_plant_model(const CraneParameters& crane, double step, const GroupArray& group_inertia,
                            const std::array<GearContact, kMaximumGroupCount>& gear);
// For who changed model.modes or model.luffing of a model whose number of modes stands: works out anew what follows from them. Allocates
// nothing.
void take_modes(PlantModel& model);
PlantWorkspace make_plant_workspace(const PlantModel& model);

// At rest, gears in the middle of their play, load hanging straight.
PlantState make_plant_state(const PlantModel& model);

// Recomputes what a state derives from its angles, speeds and modes: call it after setting those by hand. Where the
// drive is rigid, the motors' angles and speeds are derived, too.
void refresh(const PlantModel& model, PlantState& state);

// Of a whole step from this state: of the gears that are in contact then.
GearSystem gear_system(const PlantModel& model, const PlantState& state);

// Advances the state by model.step.
void step(const PlantModel& model, PlantWorkspace& workspace, const PlantInput& input, PlantState& state);

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

}  // namespace slewlab::sim
