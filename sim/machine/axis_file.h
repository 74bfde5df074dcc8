// Reads `kind: axis`: a rotary or linear axis in its natural units (docs/axis.md).
//
//   coordinate       rotary or linear
//   inertia | mass   what the motor moves, on the axis: [kg m^2] of a rotary axis, [kg] of a linear one
//   ratio            motor turns per turn of a rotary axis; absent: 1
//   travel_per_turn  [m] per motor turn of a linear axis; absent: encoder and command are those of the carriage
//   motor_inertia    [kg m^2] on the motor shaft, beside `inertia`; absent: 0, needed where the transmission gives.
//                    motor_mass [kg] of a linear axis without a turning motor
//   transmission     stiffness [Nm/rad] or [N/m] on the axis, damping_ratio, play (whole, on the axis; absent: 0);
//                    absent: rigid
//   load             constant: torque or force on the axis in the positive direction; gravity and gravity_angle: torque
//                    at the angle where it is greatest, of a rotary axis
//   load_encoder     true: a second encoder on the axis, behind the transmission
//   rated_torque     [Nm] of the motor; rated_force [N] of a linear axis without a turning motor
//   top_speed        [rad/s] or [m/s] of the axis
//   drive_protection, effects   as a crane's; torques and speeds are those of the motor shaft
#pragma once

#include "common/yaml_reader.h"
#include "sim/machine/machine_file.h"

namespace slewlab::sim {

// Of a file whose kind is an axis; problems go where the reader collects them.
void read_axis(common::YamlReader& reader, MachineFile& file);

}  // namespace slewlab::sim
