// The same machine in another size: what must not change an answer.
#pragma once

#include <cmath>

#include "sim/model/crane_parameters.h"

namespace slewlab::sim {

// All masses, inertias, stiffnesses and torques times `factor`: the same motion.
inline CraneParameters with_masses_times(CraneParameters crane, double factor) {
  for (double* number : {&crane.drive.motor_inertia, &crane.drive.brake_inertia, &crane.drive.gearbox_inertia,
                         &crane.drive.gearbox_stiffness, &crane.drive.rated_torque, &crane.house.inertia,
                         &crane.house.stiffness, &crane.boom.mass, &crane.boom.jib_mass, &crane.boom.youngs_modulus,
                         &crane.boom.shear_modulus, &crane.load.mass}) {
    *number *= factor;
  }
  return crane;
}

// All lengths times `lambda` and all times its root (Froude: gravity stays), masses as they are. A stiffness in rotation
// goes with mass * length^2 / time^2, so with lambda; the bending stiffness with mass * length^3 / time^2, lambda^2 of
// it, of which the chord's section takes lambda^4.
inline CraneParameters with_lengths_times(CraneParameters crane, double lambda) {
  for (double* number : {&crane.drive.motor_inertia, &crane.drive.brake_inertia, &crane.drive.gearbox_inertia, &crane.house.inertia}) {
    *number *= lambda * lambda;
  }
  for (double* number : {&crane.drive.gearbox_stiffness, &crane.drive.rated_torque, &crane.house.stiffness}) *number *= lambda;
  crane.drive.top_speed /= std::sqrt(lambda);
  for (double* number : {&crane.house.sensor_radius, &crane.boom.length, &crane.boom.pivot_radius, &crane.boom.chord_outer_diameter,
                         &crane.boom.chord_inner_diameter, &crane.boom.jib_eccentricity, &crane.load.rope_length, &crane.load.rod_length}) {
    *number *= lambda;
  }
  crane.boom.torsion_constant *= lambda * lambda * lambda * lambda;
  crane.boom.youngs_modulus /= lambda * lambda;
  crane.boom.shear_modulus /= lambda * lambda;
  crane.boom.highest_frequency /= std::sqrt(lambda);
  for (BoomStation& station : crane.boom.profile) {
    station.half_width *= lambda;
    station.half_height *= lambda;
  }
  return crane;
}

}  // namespace slewlab::sim
