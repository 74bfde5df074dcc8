// The scales of a machine: the few numbers from which every threshold, band, gain, bound, start and prior of generic
// code derives. A dimensionless number times a scale is the same statement about every machine: multiplying all masses
// and forces by a factor, or all lengths by lambda with all times by sqrt(lambda), changes no such statement.
//
// On the axis: the slew axis of a crane, the axis of a rotary machine [rad, kg m^2, Nm], the carriage of a linear one
// [m, kg, N]; "rad" below then reads "m".
//
//   axis_torque       = groups * motors per group * rated torque * ratio
//   axis_inertia      = all motors * ratio^2 + what they drive, the load left out
//   acceleration_time = axis_inertia * top_speed / axis_torque    from rest to top speed with the rated torque
//
// Assumption: rated torque and top speed are those the machine is built for (`drive:` of its file).
#pragma once

#include <cstddef>
#include <vector>

#include "sim/model/crane_parameters.h"

namespace slewlab::sim {

struct Scales {
  double ratio = 1.0;              // [-] motor turns per turn of the axis; [rad/m] of a linear axis
  double motor_torque = 0.0;       // [Nm] rated, of one motor
  double motor_inertia = 0.0;      // [kg m^2] of one motor with its brake and gearbox, on its shaft
  double axis_torque = 0.0;        // [Nm] rated, of all motors
  double axis_inertia = 0.0;       // [kg m^2]
  double driven_inertia = 0.0;     // [kg m^2] of axis_inertia, what is no motor
  double top_speed = 0.0;          // [rad/s] of the axis
  double acceleration_time = 0.0;  // [s]
  double reach = 0.0;              // [m] of the farthest point from the axis; 0 where nothing reaches out
  double boom_mass = 0.0;          // [kg]; 0 without a boom
};

// Throws std::invalid_argument where the machine has no inertia, rated torque or top speed.
Scales scales_of(const CraneParameters& machine);

// [Hz] Modes that matter, rising: of the whole machine with all gears in contact, without the load's pendulum, the
// first `most` of them. A rigid machine has none.
std::vector<double> structural_modes(const CraneParameters& machine, std::size_t most);

// [s] T, the characteristic time: the longer one of what the motors need to top speed and of 1.3 periods of the lowest of the
// structural modes, rising.
double characteristic_time(const Scales& scales, const std::vector<double>& structural_modes);
double characteristic_time(const CraneParameters& machine);

// [Hz] of the load's pendulum modes, rising; none without a load.
std::vector<double> pendulum_modes(const CraneParameters& machine);

}  // namespace slewlab::sim
