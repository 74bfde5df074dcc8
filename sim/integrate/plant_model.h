// What a step of the plant needs of a crane and does not change from step to step: its modes and shapes in the order in which the
// passes read them, and how modes, gears, house and load answer a step of one length. Worked out once for the whole step, and
// anew for each part of a step that changes of contact split.
#pragma once

#include <array>
#include <vector>

#include "sim/integrate/modal_pass.h"
#include "sim/integrate/oscillator.h"
#include "sim/integrate/plant_ports.h"
#include "sim/model/crane.h"

namespace slewlab::sim {

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

// Throws CannotBeBuilt for a machine without inertia or stiffness, or a rigid drive with a boom that bends or a load;
// std::invalid_argument for no groups or a step <= 0.
PlantModel make_plant_model(const CraneParameters& crane, double step);
// As make_plant_model, with each group's inertia and gears given (uneven drives).
PlantModel make_plant_model(const CraneParameters& crane, double step, const GroupArray& group_inertia,
                            const std::array<GearContact, kMaximumGroupCount>& gear);
// For who changed model.modes or model.luffing of a model whose number of modes stands: works out anew what follows from them. Allocates
// nothing.
void take_modes(PlantModel& model);

// Sizes the arrays of a step for so many modes, filled up to whole blocks.
void size_step(ModalStep& step, int padded_count);

// Works out a step of another length into `step`, which has its size. Allocates nothing.
void discretise(const PlantModel& model, const StepLength& of_length, ModalStep& step);
LoadStep discretise_load(const PlantModel& model, const StepLength& of_length);

// The system of the gears that are in contact: group i's by bit i.
void work_out(const ModalStep& step, int group_count, unsigned is_in_contact, GearSystem& result);

}  // namespace slewlab::sim
