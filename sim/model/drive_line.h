// The slew drive line: motor groups, gearboxes and the house (thesis 2.10 and 3.3.1).
//
// The model keeps every drive quantity on the slew axis. A shaft that turns i times as fast as the slew ring
// has, on the slew axis, i^2 times its inertia and stiffness, i times its torque and 1/i of its angle.
#pragma once

#include <Eigen/Core>

#include "sim/model/crane_parameters.h"
#include "sim/model/gear.h"

namespace slewlab::sim {

// Motor turns per turn of the crane: gearbox ratio times pinion ratio.
double total_ratio(const DriveParameters& drive);

// [kg m^2] of motor, brake and gearbox of one drive on the fast axis (Table 2.6).
double drive_inertia(const DriveParameters& drive);

// [kg m^2] of one whole motor group on the slew axis.
double group_inertia(const DriveParameters& drive);

// [Nm/rad] of one whole motor group's gearboxes on the slew axis; the pinion counts as rigid (2.6.2).
double group_stiffness(const DriveParameters& drive);

// [rad] half of the whole play on the slew axis: gearbox play and pinion play both turn with the pinion, so
// their sum is divided by the pinion ratio.
double half_play(const DriveParameters& drive);

// (2.19), (3.20) two inertias that swing against each other, as one [kg m^2].
double series_inertia(double first, double second);

// The group's gears on the slew axis. The damping is `gear_damping_ratio` of the critical damping of the
// (2.18) oscillator: all motors on all gearboxes against `driven_inertia` [kg m^2], the rigid crane.
GearContact gear_contact(const DriveParameters& drive, double driven_inertia);

// (3.3), (3.4) mass and stiffness matrix of the drive line, order [motor 1 ... motor N, house], from the
// inertia and stiffness of one motor and the house's inertia, all on one axis.
Eigen::MatrixXd drive_mass_matrix(int motor_count, double motor_inertia, double house_inertia);
Eigen::MatrixXd drive_stiffness_matrix(int motor_count, double gear_stiffness);

}  // namespace slewlab::sim
