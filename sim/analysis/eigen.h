// Eigenfrequencies and mode shapes of the drive line, the clamped boom and the whole crane, and what each mode
// is: undamped modes of the linear model (gears closed or open), damping ratio from the damping matrix.
//
// Kind of a mode: where most of its elastic energy sits (load: more than half in the swing of rope and rod;
// drive: more than half in the gears); what is left bends or twists the boom, whichever holds more of the
// boom's kinetic energy. Counts start at 1 within each kind, so "bending 2" is the thesis's second mode.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "sim/model/crane.h"

namespace slewlab::sim {

enum class ModeKind { kRigid, kLoad, kDrive, kBending, kTorsion };
const char* name_of(ModeKind kind);

// Shares of the mode's energies, 0 ... 1; elastic shares are 0 for a rigid mode.
struct ModeEnergy {
  double gear = 0.0;             // elastic, gearboxes
  double load = 0.0;             // potential, swing of rope and rod
  double boom = 0.0;             // elastic, bending and torsion
  double bending_motion = 0.0;   // kinetic, boom moving sideways
  double torsion_motion = 0.0;   // kinetic, boom twisting
};

struct Mode {
  double frequency = 0.0;      // [Hz], undamped
  double damping_ratio = 0.0;  // [-] diagonal of the modal damping matrix over 2 w
  ModeKind kind = ModeKind::kRigid;
  int count = 0;               // 1, 2, ... within the kind
  ModeEnergy energy;
  Eigen::VectorXd shape;       // mass-normalised, in the order of the matrices
};

// Modes of mass and stiffness matrix, rising frequencies, shapes mass-normalised. The stiffness may be
// singular; the smallest frequencies keep their digits at any number of elements. `slow_square` [1/s^2] > 0 is the square
// of a frequency of the order of the slowest mode that is not rigid; any between it and the next does as well.
struct EigenSolution {
  Eigen::VectorXd frequency;  // [Hz]
  Eigen::MatrixXd shape;      // columns
};
EigenSolution solve_eigenproblem(const Eigen::MatrixXd& mass, const Eigen::MatrixXd& stiffness, double slow_square);

// (3.3), (3.4) motors and house alone, all on one axis; order [motor 1 ... N, house].
std::vector<Mode> drive_line_modes(int motor_count, double motor_inertia, double gear_stiffness,
                                   double house_inertia);

// The boom clamped at its pivot, nodes [y, phi, psi] from the second on.
std::vector<Mode> clamped_boom_modes(const BoomParameters& boom);

// The whole crane, order of CraneMatrices.
std::vector<Mode> crane_modes(const CraneParameters& crane, GearState gears = GearState::kClosed);

// Poles [1/s] of M x'' + C x' + K x = 0 with a positive imaginary part, slowest oscillation first: frequency
// Im / 2 pi, damping ratio -Re / |pole|. The matrices need not be symmetric.
std::vector<std::complex<double>> oscillating_poles(const Eigen::MatrixXd& mass, const Eigen::MatrixXd& damping,
                                                    const Eigen::MatrixXd& stiffness);

// [Hz] of mode `count` of a kind; NaN where the machine has none.
double frequency_of(const std::vector<Mode>& modes, ModeKind kind, int count);

}  // namespace slewlab::sim
