// The boom: section, closed forms for a homogeneous boom (thesis 2.8), beam elements in lateral bending and
// torsion, damping and the kinematics of the pivot (thesis 3.3.2).
//
// Euler-Bernoulli theory, small deformations, mass spread evenly. A lattice is its four chords (2.11), an A-frame two
// of them, a box its plates. The node order is [y, phi, psi] from the pivot to the tip: lateral displacement [m], slope dy/dx [rad], twist [rad].
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

// [kg m] Mean polar mass moment per length: m (w_y^2 + w_z^2) of chords (erratum E3), m times the square of the polar radius of a box.
double mean_polar_mass(const BoomParameters& boom, double from_position, double to_position);

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

// A place on the boom's axis, by its share of the length.
struct BoomPoint {
  double radius = 0.0;  // [m] from the slew axis, level
  double height = 0.0;  // [m] above the pivot
  double angle = 0.0;   // [rad] of the boom there; at a knuckle, of the part before it
};
BoomPoint boom_point(const BoomParameters& boom, double share);
BoomPoint point_of_node(const BoomParameters& boom, int node);

// One of a straight boom, two of one with a knuckle: shares of the length and the angle [rad] above the horizontal.
struct BoomPiece {
  double from, to, angle;
};
std::vector<BoomPiece> straight_pieces(const BoomParameters& boom);

// A knuckle lies on a node: how many of the elements lie before it (all of a straight boom); [m] of an element; a node's share of the length.
int elements_before_knuckle(const BoomParameters& boom);
double length_of_element(const BoomParameters& boom, int element);
double share_of_node(const BoomParameters& boom, int node);
// [phi, psi] at the knuckle's node in the axes of the part behind it.
Eigen::Matrix2d behind_knuckle(const BoomParameters& boom);

// [N m^2] Torsional rigidity of a stretch of the boom: what twists as the stretch does under one torque.
double mean_torsional_rigidity(const BoomParameters& boom, double from_position, double to_position);

// What the luffing cylinders hold where they carry the boom, with the boom at an angle [rad]: [Nm/rad] against its twist,
// 2 k sin^2(b) (spacing / 2)^2 with their angle b to the boom; [N/m] against its deflection to the side, which compression makes negative: the
// cylinders lean with it, -F / L. k goes with the inverse of the oil column, F with the weight's lever over the cylinders'.
struct CylinderHold {
  double torsion = 0.0, lateral = 0.0;
};
CylinderHold cylinder_hold(const BoomParameters& boom, double angle);
// [m] from the boom's pivot to the cylinders' line, positive where their lower ends lie below the boom; [m] of oil column in them.
double cylinder_lever(const BoomParameters& boom, double angle);
double oil_column(const BoomParameters& boom, double angle);
// The boom as it is built, raised by an angle [rad], a knuckle keeping its bend: with the oil and the weight's lever that its cylinders have there.
BoomParameters raised_boom(BoomParameters boom, double by);
// Twist and deflection there, beyond where the turning pivot carries the boom, as sums over the nodes.
struct CylinderPlace {
  Eigen::VectorXd twist, deflection;
};
CylinderPlace cylinder_place(const BoomParameters& boom);
// [N] that the cylinders carry of the boom's own weight and `at_tip` [kg], with the boom at its angle.
double cylinder_force(const BoomParameters& boom, double at_tip);

// [m] from the slew axis to the tip, level.
double tip_radius(const BoomParameters& boom);

// [m] the same to the sheave from which the rope hangs: on the jib, jib_eccentricity in front of the boom's
// axis; it moves with y + jib_eccentricity psi of the tip.
double sheave_radius(const BoomParameters& boom);

}  // namespace slewlab::sim
