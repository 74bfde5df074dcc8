#include "sim/analysis/eigen.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "sim/model/boom.h"
#include "sim/model/drive_line.h"

namespace slewlab::sim {

namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

// [1/s^2] Square of a frequency of the order of the clamped boom's first: Rayleigh's quotient of a boom bent like a parabola.
double boom_square(const BoomMatrices& boom) {
  const Eigen::Index nodes = boom.mass.rows() / 3;
  const double length = boom.element_length * static_cast<double>(nodes - 1);
  Eigen::VectorXd bent = Eigen::VectorXd::Zero(boom.mass.rows());
  for (Eigen::Index i = 0; i < nodes; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(nodes - 1);
    bent(3 * i) = share * share * length;
    bent(3 * i + 1) = 2.0 * share;
  }
  return bent.dot(boom.stiffness * bent) / bent.dot(boom.mass * bent);
}

// [1/s^2] Square of a frequency of the order of the slowest thing that swings.
double slow_square(const CraneParameters& crane, const BoomMatrices& boom, double gear_stiffness) {
  double square = std::numeric_limits<double>::infinity();
  if (crane.load.mass > 0.0) square = std::min(square, kGravity / (crane.load.rope_length + crane.load.rod_length));
  if (crane.boom.element_count > 0) square = std::min(square, boom_square(boom));
  if (gear_stiffness > 0.0) square = std::min(square, crane.drive.group_count * gear_stiffness / driven_inertia(crane));
  return std::isfinite(square) && square > 0.0 ? square : 1.0;  // where nothing swings, any
}

void count_kinds(std::vector<Mode>& modes) {
  std::array<int, 5> counts{};
  for (Mode& mode : modes) mode.count = ++counts[static_cast<std::size_t>(mode.kind)];
}

ModeKind kind_of(bool is_rigid, const ModeEnergy& energy) {
  if (is_rigid) return ModeKind::kRigid;
  if (energy.load > 0.5) return ModeKind::kLoad;
  if (energy.gear > 0.5) return ModeKind::kDrive;
  return energy.torsion_motion > energy.bending_motion ? ModeKind::kTorsion : ModeKind::kBending;
}

// Kinetic and elastic energy of the boom for node values [y, phi, psi] of all nodes.
struct BoomEnergy {
  double bending_motion, torsion_motion, elastic;
};

BoomEnergy boom_energy(const BoomMatrices& boom, const Eigen::VectorXd& nodes) {
  Eigen::VectorXd twist = Eigen::VectorXd::Zero(nodes.size());
  for (Eigen::Index i = 2; i < nodes.size(); i += 3) twist(i) = nodes(i);
  const Eigen::VectorXd bend = nodes - twist;
  return {bend.dot(boom.mass * bend), twist.dot(boom.mass * twist), nodes.dot(boom.stiffness * nodes)};
}

}  // namespace

const char* name_of(ModeKind kind) {
  constexpr std::array<const char*, 5> kNames{"rigid", "load", "drive", "bending", "torsion"};
  return kNames.at(static_cast<std::size_t>(kind));
}

EigenSolution solve_eigenproblem(const Eigen::MatrixXd& mass, const Eigen::MatrixXd& stiffness, double slow_square) {
  // M x = mu (K + s M) x puts the slow modes at the large end of the spectrum, where a solver is accurate;
  // solved the other way round, the fastest mode's rounding swamps them. w^2 = 1/mu - s.
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(mass, stiffness + slow_square * mass);
  EigenSolution solution{.frequency = Eigen::VectorXd(mass.rows()), .shape = {}};
  solution.shape = solver.eigenvectors().rowwise().reverse();
  for (Eigen::Index k = 0; k < mass.rows(); ++k) {
    const double mu = solver.eigenvalues()(mass.rows() - 1 - k);
    solution.frequency(k) = std::sqrt(std::max(0.0, 1.0 / mu - slow_square)) / kTwoPi;
    auto shape = solution.shape.col(k);
    shape /= std::sqrt(shape.dot(mass * shape));
  }
  return solution;
}

std::vector<Mode> drive_line_modes(int motor_count, double motor_inertia, double gear_stiffness,
                                   double house_inertia) {
  const EigenSolution solution =
      solve_eigenproblem(drive_mass_matrix(motor_count, motor_inertia, house_inertia),
                         drive_stiffness_matrix(motor_count, gear_stiffness), motor_count * gear_stiffness / house_inertia);
  std::vector<Mode> modes;
  for (Eigen::Index k = 0; k < solution.frequency.size(); ++k) {
    Mode mode;
    mode.frequency = solution.frequency(k);
    mode.kind = k == 0 ? ModeKind::kRigid : ModeKind::kDrive;  // nothing holds the drive line in space
    if (mode.kind == ModeKind::kDrive) mode.energy.gear = 1.0;
    mode.shape = solution.shape.col(k);
    modes.push_back(std::move(mode));
  }
  count_kinds(modes);
  return modes;
}

std::vector<Mode> clamped_boom_modes(const BoomParameters& boom) {
  const BoomMatrices matrices = assemble_boom(boom);
  const Eigen::Index size = matrices.mass.rows() - 3;
  const EigenSolution solution = solve_eigenproblem(matrices.mass.bottomRightCorner(size, size),
                                                    matrices.stiffness.bottomRightCorner(size, size), boom_square(matrices));
  const double damping = boom_damping_coefficient(boom);
  std::vector<Mode> modes;
  for (Eigen::Index k = 0; k < size; ++k) {
    Mode mode;
    mode.frequency = solution.frequency(k);
    mode.damping_ratio = 0.5 * damping * kTwoPi * mode.frequency;
    mode.shape = solution.shape.col(k);
    Eigen::VectorXd nodes = Eigen::VectorXd::Zero(size + 3);
    nodes.tail(size) = mode.shape;
    const BoomEnergy energy = boom_energy(matrices, nodes);
    mode.energy.boom = 1.0;
    mode.energy.bending_motion = energy.bending_motion;
    mode.energy.torsion_motion = energy.torsion_motion;
    mode.kind = kind_of(false, mode.energy);
    modes.push_back(std::move(mode));
  }
  count_kinds(modes);
  return modes;
}

std::vector<Mode> crane_modes(const CraneParameters& crane, GearState gears) {
  const CraneMatrices matrices = assemble_crane(crane, gears);
  const CraneIndices& at = matrices.at;
  const int elements = crane.boom.element_count;
  BoomMatrices boom;
  if (elements > 0) boom = assemble_boom(crane.boom);
  const double gear_stiffness = gears == GearState::kClosed ? gear_contact(crane).stiffness : 0.0;
  const EigenSolution solution = solve_eigenproblem(matrices.mass, matrices.stiffness, slow_square(crane, boom, gear_stiffness));
  // Nothing holds the house in space, nor, while the gears are apart, a motor group.
  const int rigid_count = gears == GearState::kClosed ? 1 : 1 + at.group_count;

  std::vector<Mode> modes;
  for (int k = 0; k < at.size; ++k) {
    Mode mode;
    mode.frequency = solution.frequency(k);
    mode.shape = solution.shape.col(k);
    const double frequency = kTwoPi * mode.frequency;
    const double elastic = frequency * frequency;  // twice the elastic energy of a mass-normalised shape
    if (elements > 0) {
      Eigen::VectorXd nodes(3 * (elements + 1));
      nodes.head<3>() = pivot_motion(crane.boom) * mode.shape(at.house);
      nodes.tail(3 * elements) = mode.shape.segment(at.house + 1, 3 * elements);
      const BoomEnergy energy = boom_energy(boom, nodes);
      mode.energy.bending_motion = energy.bending_motion;
      mode.energy.torsion_motion = energy.torsion_motion;
      mode.energy.boom = energy.elastic / elastic;
    }
    for (int i = 0; i < at.group_count; ++i) {
      const double twist = mode.shape(i) - mode.shape(at.house);
      mode.energy.gear += gear_stiffness * twist * twist / elastic;
    }
    for (const int swing : {at.rope, at.rod}) {
      if (swing < 0) continue;
      mode.energy.load += matrices.stiffness(swing, swing) * mode.shape(swing) * mode.shape(swing) / elastic;
    }
    mode.kind = kind_of(k < rigid_count, mode.energy);
    if (mode.kind == ModeKind::kRigid) {
      mode.energy.gear = mode.energy.load = mode.energy.boom = 0.0;
    } else {
      mode.damping_ratio = 0.5 * mode.shape.dot(matrices.damping * mode.shape) / frequency;
    }
    modes.push_back(std::move(mode));
  }
  count_kinds(modes);
  return modes;
}

std::vector<std::complex<double>> oscillating_poles(const Eigen::MatrixXd& mass, const Eigen::MatrixXd& damping,
                                                    const Eigen::MatrixXd& stiffness) {
  const Eigen::Index size = mass.rows();
  const Eigen::PartialPivLU<Eigen::MatrixXd> factors(mass);
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(2 * size, 2 * size);
  system.topRightCorner(size, size).setIdentity();
  system.bottomLeftCorner(size, size) = -factors.solve(stiffness);
  system.bottomRightCorner(size, size) = -factors.solve(damping);
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(system, false);
  std::vector<std::complex<double>> poles;
  for (Eigen::Index k = 0; k < 2 * size; ++k) {
    if (solver.eigenvalues()(k).imag() > 0.0) poles.push_back(solver.eigenvalues()(k));
  }
  std::sort(poles.begin(), poles.end(), [](const auto& a, const auto& b) { return a.imag() < b.imag(); });
  return poles;
}

double frequency_of(const std::vector<Mode>& modes, ModeKind kind, int count) {
  for (const Mode& mode : modes) {
    if (mode.kind == kind && mode.count == count) return mode.frequency;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace slewlab::sim
