// The boom on its free house at any boom angle, fast enough to be worked out while the boom luffs.
//
// Coordinates: the house's angle theta and the boom's deflection from where the turning house would carry it, in the modes of the boom
// clamped to a house that stands. A boom angle changes neither those modes nor their stiffness and damping (but for luffing cylinders, below),
// only what a turn of the house does to the boom's nodes, u = [r_pivot, cos a, sin a] times (y = 1; y = x, phi = 1; psi = 1), (3.16). So
//
//   I(a) theta'' + sum c_j(a) eta_j''                          = torque on the house + R(a) F_tip + ...
//   c_j(a) theta'' + eta_j'' + a_1 w_j^2 eta_j' + w_j^2 eta_j  = W_tip,j F_tip + ...
//
// with I = J_house + u^T G u and c_j = g_j u. The free-house modes of (crane.h) are the roots of the secular equation of this arrow:
// one between each two neighbouring w_j^2 and one above the last,
//
//   f(lambda) = I + sum_j lambda c_j^2 / (w_j^2 - lambda) = 0,   eta_j = lambda c_j theta / (w_j^2 - lambda),
//
// each found by halving from its nearer pole, so that even a mode that hardly turns the house keeps its digits.
//
// Luffing cylinders hold the boom the more or the less with the angle: on the modes of the boom clamped at the angle of the start there stands
// the stiffness diag(w_j^2) + dk_t t t^T + dk_y d d^T (cylinder_hold(), boom.h). Its own modes, by a solver of symmetric matrices, are the w_j
// of the arrow then. What shapes are told in stays the modes of the start.
// Source: textbook (the eigenproblem of an arrow matrix); the boom's matrices are the thesis's (boom.h).
#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <vector>

#include "sim/model/boom.h"
#include "sim/model/crane.h"

namespace slewlab::sim {

struct LuffingBoom {
  double house_inertia = 0.0;  // [kg m^2]
  double jib_eccentricity = 0.0;  // [m]
  double damping = 0.0;        // [s] a_1
  double pivot_radius = 0.0;   // [m]
  Eigen::Matrix3d rigid = Eigen::Matrix3d::Zero();  // G: I = house_inertia + u^T G u
  std::vector<double> square;  // [1/s^2] of the clamped boom's modes, rising
  Eigen::MatrixXd coupling;    // g_j by rows: c = coupling * u
  // What a turn (columns of u) and each clamped mode do: displacements of sheave and middle, twist of the tip, integral along the boom.
  Eigen::Vector3d sheave_turn, middle_turn, twist_turn, uniform_turn;
  Eigen::VectorXd sheave, middle, twist, uniform;
  Eigen::MatrixXd shear;  // [N] element by clamped mode
  BoomParameters parameters;  // at the start
  Eigen::VectorXd cylinder_twist, cylinder_deflection;  // of each clamped mode where luffing cylinders carry it; empty without them
};

// Throws CannotBeBuilt where the house gives (a slew ring on a spring): its modes would be no such arrow; and where luffing cylinders do not hold
// the boom at its lowest or highest angle.
LuffingBoom luffing_boom(const CraneParameters& crane);

// [Nm/rad], [N/m] what luffing cylinders hold more than at the start.
CylinderHold further_hold(const LuffingBoom& boom, double angle);

// Room for the eigenvalues of a symmetric matrix.
struct HeldSolver {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd diagonal, beside;
  Eigen::Tridiagonalization<Eigen::MatrixXd> tridiagonal;
  // It has solved something from the beginning: before, Eigen leaves a member unset, which may not be copied.
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes{Eigen::MatrixXd::Zero(1, 1)};
};

// One boom angle. Sized once by basis_at(); luff_to() writes into it and allocates nothing.
struct LuffedBasis {
  double angle = 0.0;            // [rad]
  double inertia = 0.0;          // [kg m^2] I
  double inertia_slope = 0.0;    // [kg m^2/rad] dI/da
  double sheave_radius = 0.0;    // [m]
  Eigen::VectorXd coupling;        // c
  Eigen::VectorXd coupling_slope;  // dc/da
  Eigen::VectorXd house;         // theta of each free-house mode
  Eigen::MatrixXd deflection;    // eta_j (row) of each free-house mode (column)
  FreeHouseModes modes;
  // Of the boom clamped at this angle: squares of its modes and what a turn does to them; on cylinders, their shapes by columns in the modes of
  // the start, and what finds them.
  std::vector<double> square;
  Eigen::VectorXd held_coupling, room;
  Eigen::MatrixXd held_shapes;
  HeldSolver solver;
};
LuffedBasis basis_at(const LuffingBoom& boom, double angle, int mode_count);
void luff_to(const LuffingBoom& boom, double angle, LuffedBasis& basis);

// [m/rad], [m/rad^2] how the sheave's radius and height change with the boom angle.
struct SheavePath {
  double radius_slope = 0.0;
  double height_slope = 0.0, height_curve = 0.0;
};
SheavePath sheave_path(const LuffingBoom& boom, double angle);
// [m/rad] of the boom's middle.
double middle_radius_slope(const LuffingBoom& boom, double angle);

}  // namespace slewlab::sim
