#include "sim/model/luffing.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "sim/model/boom.h"
#include "sim/model/cannot_be_built.h"

namespace slewlab::sim {
namespace {

// Of what couples a clamped mode to the house, as a share of the root of the inertia: a mode that a turn does not stir at all (torsion of a
// level boom) keeps a place between its poles.
constexpr double kLeastCoupling = 1e-12;
// As a share of the lower of two poles: modes of the held boom may pass each other while it luffs, the secular equation needs a gap.
constexpr double kLeastGap = 1e-9;
constexpr int kMostSteps = 200;      // to a root; five to ten are usual
constexpr double kRounding = 4e-16;  // [-] of a number

Eigen::Vector3d turn(double pivot_radius, double angle) { return {pivot_radius, std::cos(angle), std::sin(angle)}; }
Eigen::Vector3d turn_slope(double angle) { return {0.0, -std::sin(angle), std::cos(angle)}; }

// The three parts of u at a place of the boom: of its lateral displacement, its slope and its twist. At a knuckle the part before it; the bend
// there stays as it is while the boom luffs.
struct Turns {
  Eigen::Vector3d displacement, slope, twist;
};
Turns turns_at(const BoomParameters& boom, const BoomPoint& point) {
  // Along and across the boom's axis at the pivot.
  const double level = point.radius - boom.pivot_radius, c = std::cos(boom.angle), s = std::sin(boom.angle);
  const double along = level * c + point.height * s, across = point.height * c - level * s, bend = point.angle - boom.angle;
  return {{1.0, along, -across}, {0.0, std::cos(bend), -std::sin(bend)}, {0.0, std::sin(bend), std::cos(bend)}};
}

// Rows [y, phi, psi] of every node.
Eigen::MatrixXd turns_of_nodes(const BoomParameters& boom) {
  Eigen::MatrixXd rows(3 * (boom.element_count + 1), 3);
  for (int node = 0; node <= boom.element_count; ++node) {
    const Turns turns = turns_at(boom, point_of_node(boom, node));
    rows.row(3 * node) = turns.displacement.transpose();
    rows.row(3 * node + 1) = turns.slope.transpose();
    rows.row(3 * node + 2) = turns.twist.transpose();
  }
  return rows;
}

// G of a boom that does not bend.
Eigen::Matrix3d rigid_masses(const BoomParameters& boom) {
  Eigen::Matrix3d masses = Eigen::Matrix3d::Zero();
  const double mass_per_length = boom.mass / boom.length;
  for (const BoomPiece& piece : straight_pieces(boom)) {
    const double l = boom.length * (piece.to - piece.from);
    BoomPoint begin = boom_point(boom, piece.from);
    begin.angle = piece.angle;
    const Turns turns = turns_at(boom, begin);
    const Eigen::Vector3d &p = turns.displacement, &d = turns.slope, &t = turns.twist;
    masses += mass_per_length * (l * p * p.transpose() + 0.5 * l * l * (p * d.transpose() + d * p.transpose()) + l * l * l / 3.0 * d * d.transpose()) +
              mean_polar_mass(boom, piece.from, piece.to) * l * t * t.transpose();
  }
  return masses;
}

// What reads a displacement off the nodes.
struct Readers {
  Eigen::VectorXd sheave, middle, twist, uniform;
  Eigen::MatrixXd shear;
};

Readers readers_of(const BoomParameters& boom, const std::vector<double>& rigidity) {
  const int n = boom.element_count;
  const int before = elements_before_knuckle(boom);
  const Eigen::Index size = 3 * (n + 1);
  Readers readers{.sheave = Eigen::VectorXd::Zero(size), .middle = Eigen::VectorXd::Zero(size), .twist = Eigen::VectorXd::Zero(size),
                  .uniform = Eigen::VectorXd::Zero(size), .shear = Eigen::MatrixXd::Zero(n, size)};
  readers.sheave(3 * n) = 1.0;
  readers.sheave(3 * n + 2) = boom.jib_eccentricity;
  readers.twist(3 * n + 2) = 1.0;
  for (int e = 0; e < n; ++e) {
    // Cubic shape functions of the element: its integral, its third derivative, its value at half of the boom's length.
    const double h = length_of_element(boom, e);
    const Eigen::RowVector2d slope = e > 0 && e == before ? Eigen::RowVector2d(behind_knuckle(boom).row(0)) : Eigen::RowVector2d(1.0, 0.0);
    const auto add = [&](auto row, double y1, double phi1, double y2, double phi2) {
      row(3 * e) += y1;
      row(3 * e + 1) += slope(0) * phi1;
      row(3 * e + 2) += slope(1) * phi1;
      row(3 * e + 3) += y2;
      row(3 * e + 4) += phi2;
    };
    add(readers.uniform.transpose(), 0.5 * h, h * h / 12.0, 0.5 * h, -h * h / 12.0);
    const double force = rigidity[static_cast<std::size_t>(e)] / (h * h * h);
    add(readers.shear.row(e), 12.0 * force, 6.0 * h * force, -12.0 * force, 6.0 * h * force);
    const double s = (0.5 - share_of_node(boom, e)) * boom.length / h;
    if (s >= 0.0 && (s < 1.0 || (s == 1.0 && e + 1 == n))) {
      const double s2 = s * s, s3 = s2 * s;
      add(readers.middle.transpose(), 1 - 3 * s2 + 2 * s3, h * (s - 2 * s2 + s3), 3 * s2 - 2 * s3, h * (s3 - s2));
    }
  }
  return readers;
}

// f of the secular equation at lambda = pole + offset, where differences to the poles keep their digits, and its slope.
struct Secular {
  double value, slope;
};
Secular secular(const LuffedBasis& basis, double pole, double offset) {
  Secular f{.value = basis.inertia, .slope = 0.0};
  const double lambda = pole + offset;
  for (std::size_t j = 0; j < basis.square.size(); ++j) {
    const double c = basis.held_coupling(static_cast<Eigen::Index>(j));
    const double per_distance = c / ((basis.square[j] - pole) - offset);
    f.value += lambda * c * per_distance;
    f.slope += basis.square[j] * per_distance * per_distance;
  }
  return f;
}

struct Root {
  double pole, offset;
};

// The root between the k-th pole and the next, or above the last; f rises from minus to plus infinity between two poles. Newton's steps on
// offset * f, which has no pole where the offset is 0, within a bracket that is halved where they leave it.
Root root_above(const LuffedBasis& basis, std::size_t k) {
  const bool is_last = k + 1 == basis.square.size();
  const double left = basis.square[k];
  double gap = is_last ? left : basis.square[k + 1] - left;
  if (is_last) {
    // f rises towards I - sum c^2, which is positive.
    while (secular(basis, left, gap).value < 0.0) gap *= 2.0;
  }
  const bool is_left = is_last || secular(basis, left, 0.5 * gap).value >= 0.0;
  const double pole = is_left ? left : basis.square[k + 1];
  double low = is_left ? 0.0 : -0.5 * gap, high = is_left ? (is_last ? gap : 0.5 * gap) : 0.0;
  double offset = 0.5 * (low + high);
  for (int i = 0; i < kMostSteps; ++i) {
    const Secular f = secular(basis, pole, offset);
    (f.value < 0.0 ? low : high) = offset;
    double next = offset - offset * f.value / (f.value + offset * f.slope);
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    const bool is_there = std::fabs(next - offset) <= kRounding * std::fabs(offset);
    offset = next;
    if (is_there) break;
  }
  return {pole, offset};
}

// Eigenvalues and, as columns of `shapes`, eigenvectors of the solver's matrix. Eigen's own way from a full matrix to its eigenvectors takes
// memory for the reflections; here they are applied to the eigenvectors of the tridiagonal matrix where these stand.
void solve(HeldSolver& solver, Eigen::MatrixXd& shapes) {
  solver.tridiagonal.compute(solver.matrix);
  const Eigen::MatrixXd& packed = solver.tridiagonal.packedMatrix();
  solver.diagonal = packed.diagonal();
  solver.beside = packed.diagonal<-1>();
  solver.modes.computeFromTridiagonal(solver.diagonal, solver.beside);
  shapes = solver.modes.eigenvectors();
  const Eigen::Index size = shapes.rows();
  for (Eigen::Index i = size - 2; i >= 0; --i) {
    // I - h v v^T on the rows behind i, v = [1, what stands below the second diagonal].
    const auto v = packed.col(i).tail(size - i - 2);
    const double square = v.squaredNorm();
    if (square == 0.0) continue;
    const double h = 2.0 / (1.0 + square);
    for (Eigen::Index k = 0; k < size; ++k) {
      const double reflected = h * (shapes(i + 1, k) + v.dot(shapes.col(k).tail(size - i - 2)));
      shapes(i + 1, k) -= reflected;
      shapes.col(k).tail(size - i - 2) -= reflected * v;
    }
  }
}

// The clamped boom's own modes at the angle, where its cylinders hold it otherwise than at the start.
void hold(const LuffingBoom& boom, LuffedBasis& basis) {
  const CylinderHold further = further_hold(boom, basis.angle);
  const Eigen::VectorXd &twist = boom.cylinder_twist, &deflection = boom.cylinder_deflection;
  Eigen::MatrixXd& stiffness = basis.solver.matrix;
  for (Eigen::Index j = 0; j < twist.size(); ++j) {
    for (Eigen::Index i = 0; i < twist.size(); ++i) {
      stiffness(i, j) = further.torsion * twist(i) * twist(j) + further.lateral * deflection(i) * deflection(j);
    }
    stiffness(j, j) += boom.square[static_cast<std::size_t>(j)];
  }
  solve(basis.solver, basis.held_shapes);
  double below = 0.0;
  for (std::size_t j = 0; j < basis.square.size(); ++j) {
    below = basis.square[j] = std::max(basis.solver.modes.eigenvalues()(static_cast<Eigen::Index>(j)), below * (1.0 + kLeastGap));
  }
}

void expect_it_holds(const LuffingBoom& boom, double angle) {
  LuffedBasis basis = basis_at(boom, angle, 1);
  hold(boom, basis);
  if (!(basis.solver.modes.eigenvalues()(0) > 0.0)) {
    throw CannotBeBuilt("the luffing cylinders push the boom over to the side at " + std::to_string(angle) + " rad: they carry too much for their length");
  }
}

}  // namespace

LuffingBoom luffing_boom(const CraneParameters& crane) {
  const BoomParameters& boom = crane.boom;
  if (crane.house.stiffness > 0.0) throw CannotBeBuilt("a boom luffs on a rigid house only: the house of this machine is a ring on a spring");
  LuffingBoom result;
  result.parameters = boom;
  result.house_inertia = crane.house.inertia;
  result.jib_eccentricity = boom.jib_eccentricity;
  result.pivot_radius = boom.pivot_radius;
  const Turns tip = turns_at(boom, boom_point(boom, 1.0));
  result.sheave_turn = tip.displacement + boom.jib_eccentricity * tip.twist;
  result.twist_turn = tip.twist;
  result.middle_turn = turns_at(boom, boom_point(boom, 0.5)).displacement;
  result.uniform_turn.setZero();
  for (const BoomPiece& piece : straight_pieces(boom)) {
    const BoomPoint middle = boom_point(boom, 0.5 * (piece.from + piece.to));
    result.uniform_turn += boom.length * (piece.to - piece.from) * turns_at(boom, middle).displacement;
  }
  if (boom.element_count == 0) {
    result.rigid = rigid_masses(boom) + boom.jib_mass * result.sheave_turn * result.sheave_turn.transpose();
    return result;
  }
  const BoomMatrices matrices = assemble_boom(boom);
  const Eigen::Index size = matrices.mass.rows(), free = size - 3;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrices.stiffness.bottomRightCorner(free, free),
                                                                         matrices.mass.bottomRightCorner(free, free));
  const Eigen::MatrixXd turns = turns_of_nodes(boom);
  const Eigen::MatrixXd mass_of_turns = matrices.mass * turns;
  const Eigen::MatrixXd& shapes = solver.eigenvectors();
  result.damping = boom_damping_coefficient(boom);
  result.rigid = turns.transpose() * mass_of_turns;
  result.coupling = shapes.transpose() * mass_of_turns.bottomRows(free);
  for (const double square : solver.eigenvalues()) result.square.push_back(square);
  for (std::size_t j = 1; j < result.square.size(); ++j) {
    if (!(result.square[j] > result.square[j - 1] * (1.0 + 1e-9))) {
      throw CannotBeBuilt("two modes of the clamped boom have one frequency: change the number of elements or the torsion constant a little");
    }
  }
  const Readers readers = readers_of(boom, matrices.element_rigidity);
  result.sheave = shapes.transpose() * readers.sheave.tail(free);
  result.middle = shapes.transpose() * readers.middle.tail(free);
  result.twist = shapes.transpose() * readers.twist.tail(free);
  result.uniform = shapes.transpose() * readers.uniform.tail(free);
  result.shear = readers.shear.rightCols(free) * shapes;
  if (boom.cylinders.stiffness > 0.0) {
    const CylinderPlace place = cylinder_place(boom);
    result.cylinder_twist = shapes.transpose() * place.twist.tail(free);
    result.cylinder_deflection = shapes.transpose() * place.deflection.tail(free);
    for (const double angle : {crane.motions.lowest_angle, crane.motions.highest_angle}) {
      if (crane.motions.luffing.top_speed > 0.0) expect_it_holds(result, angle);
    }
  }
  return result;
}

CylinderHold further_hold(const LuffingBoom& boom, double angle) {
  const CylinderHold start = cylinder_hold(boom.parameters, boom.parameters.angle), now = cylinder_hold(boom.parameters, angle);
  return {.torsion = now.torsion - start.torsion, .lateral = now.lateral - start.lateral};
}

LuffedBasis basis_at(const LuffingBoom& boom, double angle, int mode_count) {
  const auto count = static_cast<Eigen::Index>(boom.square.size());
  const auto modes = static_cast<std::size_t>(mode_count);
  LuffedBasis basis;
  basis.coupling = basis.coupling_slope = basis.held_coupling = basis.room = Eigen::VectorXd::Zero(count);
  basis.square = boom.square;
  if (boom.cylinder_twist.size() > 0) {
    basis.held_shapes = Eigen::MatrixXd::Zero(count, count);
    basis.solver = {.matrix = Eigen::MatrixXd::Zero(count, count),
                    .diagonal = Eigen::VectorXd::Zero(count),
                    .beside = Eigen::VectorXd::Zero(count - 1),
                    .tridiagonal = Eigen::Tridiagonalization<Eigen::MatrixXd>(count),
                    .modes = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(Eigen::MatrixXd::Zero(count, count))};
  }
  basis.house = Eigen::VectorXd::Zero(mode_count);
  basis.deflection = Eigen::MatrixXd::Zero(count, mode_count);
  FreeHouseModes& free = basis.modes;
  for (auto* values : {&free.frequency, &free.damping_rate, &free.house, &free.pivot, &free.tip, &free.middle, &free.tip_twist, &free.uniform_load}) {
    values->assign(modes, 0.0);
  }
  free.shear = Eigen::MatrixXd::Zero(boom.shear.rows(), mode_count);
  luff_to(boom, angle, basis);
  return basis;
}

namespace {

// Masses, and the modes of the clamped boom where they are asked for.
void turn_to(const LuffingBoom& boom, double angle, LuffedBasis& basis) {
  const Eigen::Vector3d u = turn(boom.pivot_radius, angle), slope = turn_slope(angle);
  basis.angle = angle;
  const Eigen::Vector3d rigid = boom.rigid * u;
  basis.inertia = boom.house_inertia + u.dot(rigid);
  basis.inertia_slope = 2.0 * slope.dot(rigid);
  basis.sheave_radius = boom.sheave_turn.dot(u);
  const double least = kLeastCoupling * std::sqrt(basis.inertia);
  const auto at_least = [least](double c) { return std::fabs(c) > least ? c : std::copysign(least, c); };
  for (Eigen::Index j = 0; j < basis.coupling.size(); ++j) {
    double c = 0.0, c_slope = 0.0;
    for (Eigen::Index i = 0; i < 3; ++i) {
      c += boom.coupling(j, i) * u(i);
      c_slope += boom.coupling(j, i) * slope(i);
    }
    basis.coupling(j) = at_least(c);
    basis.coupling_slope(j) = c_slope;
  }
  basis.held_coupling = basis.coupling;
  if (boom.cylinder_twist.size() == 0 || basis.house.size() < 2) return;
  hold(boom, basis);
  basis.held_coupling.noalias() = basis.held_shapes.transpose() * basis.coupling;
  for (double& c : basis.held_coupling) c = at_least(c);
}

}  // namespace

void luff_to(const LuffingBoom& boom, double angle, LuffedBasis& basis) {
  turn_to(boom, angle, basis);
  const Eigen::Vector3d u = turn(boom.pivot_radius, angle);
  const auto count = static_cast<Eigen::Index>(boom.square.size());
  const bool is_held = boom.cylinder_twist.size() > 0;
  const double sheave_turn = basis.sheave_radius, middle_turn = boom.middle_turn.dot(u);
  const double twist_turn = boom.twist_turn.dot(u), uniform_turn = boom.uniform_turn.dot(u);

  FreeHouseModes& free = basis.modes;
  for (Eigen::Index k = 0; k < basis.house.size(); ++k) {
    const auto mode = static_cast<std::size_t>(k);
    const Root root = k == 0 ? Root{0.0, 0.0} : root_above(basis, mode - 1);
    const double lambda = root.pole + root.offset;
    // Of a turn by 1 rad; then all of it over the root of its modal mass.
    double mass = basis.inertia;
    for (Eigen::Index j = 0; j < count; ++j) {
      const double c = basis.held_coupling(j);
      const double eta = k == 0 ? 0.0 : lambda * c / ((basis.square[static_cast<std::size_t>(j)] - root.pole) - root.offset);
      basis.deflection(j, k) = eta;
      mass += (2.0 * c + eta) * eta;
    }
    if (is_held && k > 0) {
      basis.room.noalias() = basis.held_shapes * basis.deflection.col(k);
      basis.deflection.col(k) = basis.room;
    }
    double scale = 1.0 / std::sqrt(mass);
    double sheave = sheave_turn, middle = middle_turn, twist = twist_turn, uniform = uniform_turn;
    for (Eigen::Index j = 0; j < count; ++j) {
      const double eta = basis.deflection(j, k);
      sheave += boom.sheave(j) * eta;
      middle += boom.middle(j) * eta;
      twist += boom.twist(j) * eta;
      uniform += boom.uniform(j) * eta;
    }
    // The tip moves to the positive side (crane.h).
    if (sheave - boom.jib_eccentricity * twist < 0.0) scale = -scale;
    for (Eigen::Index j = 0; j < count; ++j) basis.deflection(j, k) *= scale;
    basis.house(k) = scale;
    free.frequency[mode] = std::sqrt(lambda);
    free.damping_rate[mode] = boom.damping * lambda;
    free.house[mode] = free.pivot[mode] = scale;
    free.tip[mode] = scale * sheave;
    free.middle[mode] = scale * middle;
    free.tip_twist[mode] = scale * twist;
    free.uniform_load[mode] = scale * uniform;
    for (Eigen::Index e = 0; e < boom.shear.rows(); ++e) {
      double force = 0.0;
      for (Eigen::Index j = 0; j < count; ++j) force += boom.shear(e, j) * basis.deflection(j, k);
      free.shear(e, k) = force;
    }
  }
}

SheavePath sheave_path(const LuffingBoom& boom, double angle) {
  // The sheave lies `along` and `across` the axis that the boom has at its pivot.
  const double along = boom.sheave_turn(1), across = -boom.sheave_turn(2), c = std::cos(angle), s = std::sin(angle);
  return {.radius_slope = -along * s - across * c, .height_slope = along * c - across * s, .height_curve = -along * s - across * c};
}

double middle_radius_slope(const LuffingBoom& boom, double angle) { return boom.middle_turn.dot(turn_slope(angle)); }

}  // namespace slewlab::sim
