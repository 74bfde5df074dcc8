// The load as a double pendulum in the sidelead direction (thesis 2.9 and 3.3.3).
//
// Small angles, a massless rope of length L_wr and a uniform rod of length L_l and mass M_l below it. States
// [y_b, beta_1, beta_2]: displacement of the rope's top [m], rope angle and rod angle against the vertical
// [rad].
#pragma once

#include <Eigen/Core>

#include "sim/model/crane_parameters.h"

namespace slewlab::sim {

// (2.17) [Hz] of a point mass on a rope.
double pendulum_frequency(double rope_length);

// (3.18) with entry (1,3) = M L_l / 2 and entry (3,3) = M L_l^2 / 3 (erratum E1).
Eigen::Matrix3d load_mass_matrix(const LoadParameters& load);
// (3.18) as printed: not symmetric. For its erratum's test only.
Eigen::Matrix3d load_mass_matrix_as_printed(const LoadParameters& load);

// (3.19)
Eigen::Matrix3d load_stiffness_matrix(const LoadParameters& load);

// (3.29) [rad] largest rope angle after the rope's top is brought to `speed` [m/s] at once.
double swing_angle(double speed, double rope_length);

// (4.1) [Nm] quasi-static slewing moment: inertia and load at one acceleration [rad/s^2] and one sidelead angle
// [rad]. The print takes the rope length for `arm` [m]; the side force of the load acts at the tip radius
// (erratum E7).
double quasi_static_slewing_moment(double inertia, double acceleration, double load_mass, double arm,
                                   double sidelead);

// The load seen from the boom tip, in the absolute displacement y_1 [m] of the rope's lower end and beta_2.
// With y_1 = y_b + L_wr beta_1 the rows of (3.18) say M (y_1'' + L_l/2 beta_2'') = -M g (y_1 - y_b) / L_wr:
// the rope is a spring from tip to load, and the tip feels no mass of the load at all.
//
//   M [y_1; beta_2]'' + C [y_1' - y_b'; beta_2'] + K [y_1 - y_b; beta_2] = 0,  K = diag(M g/L_wr, M g L_l/2),
//   force on the tip = first row of C [..] + K [..].
//
// C gives each of the two swinging modes `damping_ratio` of its critical damping. `modes` holds the
// mass-normalised shapes as columns, `frequency` their angular frequencies [rad/s]. A point load (rod length
// 0) has one mode; its second one rests.
struct LoadOnSpring {
  double rope_stiffness = 0.0;  // [N/m] M g / L_wr
  Eigen::Matrix2d mass = Eigen::Matrix2d::Zero();
  Eigen::Matrix2d stiffness = Eigen::Matrix2d::Zero();
  Eigen::Matrix2d damping = Eigen::Matrix2d::Zero();
  Eigen::Matrix2d modes = Eigen::Matrix2d::Zero();
  Eigen::Vector2d frequency = Eigen::Vector2d::Zero();
};
LoadOnSpring load_on_spring(const LoadParameters& load);

// A rope whose length is not the load's own (hoisting), or whose top moves up and down. With y the difference of the displacements of the
// rope's lower end and its top, a the load's acceleration upwards and L the rope's length now, the tension is M (g + a) and
//   force on the load - M (g + a) y / L,  on the rod - M (g + a) L_l beta_2 / 2,
// which holds the pendulum's L beta'' + 2 L' beta' + g beta = 0 of a rope that is hoisted, a = -L''. These are the differences to the rope
// at rest; the force on the tip is that on the load, turned around.
struct RopeForces {
  double load_force = 0.0;  // [N] on the rope's lower end
  double rod_moment = 0.0;  // [Nm]
};
RopeForces moving_rope(const LoadParameters& load, double length, double upward_acceleration, double difference, double rod_angle);

}  // namespace slewlab::sim
