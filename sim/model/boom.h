// The boom: section, closed forms for a homogeneous boom (thesis 2.8), beam elements in lateral bending and
// torsion, damping and the kinematics of the pivot (thesis 3.3.2).
//
// Euler-Bernoulli theory, small deformations, mass spread evenly, chords only (2.11). The node order is
// [y, phi, psi] from the pivot to the tip: lateral displacement [m], slope dy/dx [rad], twist [rad].
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/model/crane_parameters.h"

namespace slewlab::sim {

using Matrix6d = Eigen::Matrix<double, 6, 6>;

// (2.11) [m^4] second moment of area of four chords of the given diameters [m] at the half width w_b [m].
double second_moment_of_area(double outer_diameter, double inner_diameter, double half_width);

// Profile, linear between its stations; `position` is a share of the length, 0 ... 1.
BoomStation station_at(const BoomParameters& boom, double position);

// Mean of (2.11) over a stretch of the boom, exact for a piecewise linear profile: what a beam element gets.
double mean_second_moment(const BoomParameters& boom, double from_position, double to_position);

// (2.12) [N/m] lateral stiffness of a homogeneous clamped boom.
double lateral_stiffness(double youngs_modulus, double second_moment, double length);

// (2.13) [kg m^2] inertia of the boom about the slew axis, from the mean half width.
double boom_inertia(const BoomParameters& boom, double mean_half_width);

// [kg m^2] the same for the beam of this model (no width): integral of m (r_pivot + x cos a)^2, plus the
// polar inertia that a slewing boom turns about its own axis.
double rigid_boom_inertia(const BoomParameters& boom);

// (2.14) [Hz] of bending mode 1, 2 or 3 of a homogeneous clamped boom.
double clamped_frequency(int mode, double youngs_modulus, double second_moment, double mass, double length);

// (2.15) ratio of the natural frequency under compression to the one without.
double compression_factor(double compression, double critical_force);

// (2.16) [N] critical buckling load. Table 2.4 gives 128 MN; the print says 287 MN (erratum E6).
double critical_buckling_force(double youngs_modulus, double second_moment, double length);

// (3.8) and (3.9), in the order [y, phi, y, phi]; (3.10) and (3.11), in the order [psi, psi].
// (3.10) with the polar mass moment per length [kg m] in place of m I_t / A (erratum E3).
Eigen::Matrix4d bending_mass(double mass_per_length, double length);
Eigen::Matrix4d bending_stiffness(double bending_rigidity, double length);
Eigen::Matrix2d torsion_mass(double polar_mass_per_length, double length);
Eigen::Matrix2d torsion_stiffness(double torsional_rigidity, double length);

// (3.12), (3.13): one element, order [y, phi, psi, y, phi, psi].
Matrix6d element_mass(double mass_per_length, double polar_mass_per_length, double length);
Matrix6d element_stiffness(double bending_rigidity, double torsional_rigidity, double length);

// (3.15) a_1 [s] of Rayleigh damping that, with a_0 = a_1 w1 w2, has the ratio at both frequencies:
// 2 zeta / (w1 + w2). The print has a plus where a minus belongs (erratum E2). The thesis drops a_0: what is
// left is zeta w_i / (w1 + w2) at each of the two, so low modes are damped less than high ones.
double stiffness_damping_coefficient(double damping_ratio, double first_frequency, double second_frequency);
double stiffness_damping_coefficient_as_printed(double damping_ratio, double first_frequency,
                                                double second_frequency);

// The boom's own matrices, free at both ends (Figure 3.7).
struct BoomMatrices {
  Eigen::MatrixXd mass;
  Eigen::MatrixXd stiffness;
  std::vector<double> element_rigidity;  // [N m^2] E I of each element
  double element_length = 0.0;           // [m]
};
BoomMatrices assemble_boom(const BoomParameters& boom);

// (3.16) motion of the pivot node [y, phi, psi] for one radian of slew: [r_pivot, cos a, sin a].
Eigen::Vector3d pivot_motion(const BoomParameters& boom);

// (3.17) merges the pivot node into the house's rotation: order [theta_h, nodes 2 ... n+1].
Eigen::MatrixXd merge_pivot(const Eigen::MatrixXd& boom_matrix, const Eigen::Vector3d& pivot);

// Natural frequencies [rad/s] of the clamped boom, lateral bending only, rising.
std::vector<double> clamped_bending_frequencies(const BoomParameters& boom);

// a_1 [s] of this boom, from its damping ratio and the first two bending modes of the clamped boom.
double boom_damping_coefficient(const BoomParameters& boom);

// [m] from the slew axis to the tip, level.
double tip_radius(const BoomParameters& boom);

// [m] the same to the sheave from which the rope hangs: on the jib, jib_eccentricity in front of the boom's
// axis; it moves with y + jib_eccentricity psi of the tip.
double sheave_radius(const BoomParameters& boom);

}  // namespace slewlab::sim
