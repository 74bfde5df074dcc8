#include "sim/model/crane.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/model/boom.h"
#include "sim/model/drive_line.h"

namespace slewlab::sim {

namespace {

// House and boom, order [slew ring where the house is not rigid, theta_h, nodes from the second on].
struct HouseAndBoom {
  Eigen::MatrixXd mass;
  Eigen::MatrixXd stiffness;
};

// 1 where the slew ring has a degree of freedom of its own before the house's, 0 where the house is rigid.
int house_root(const HouseParameters& house) { return house.stiffness > 0.0 ? 1 : 0; }

// Puts a slew ring on a spring before the house's rotation; the gears push on it.
HouseAndBoom with_ring(const HouseAndBoom& rigid, const HouseParameters& house) {
  const Eigen::Index size = rigid.mass.rows();
  HouseAndBoom result{.mass = Eigen::MatrixXd::Zero(size + 1, size + 1),
                      .stiffness = Eigen::MatrixXd::Zero(size + 1, size + 1)};
  result.mass.bottomRightCorner(size, size) = rigid.mass;
  result.stiffness.bottomRightCorner(size, size) = rigid.stiffness;
  const double ring = house.ring_share * house.inertia;
  result.mass(0, 0) += ring;
  result.mass(1, 1) -= ring;
  result.stiffness(0, 0) += house.stiffness;
  result.stiffness(1, 1) += house.stiffness;
  result.stiffness(0, 1) -= house.stiffness;
  result.stiffness(1, 0) -= house.stiffness;
  return result;
}

HouseAndBoom assemble_house_and_boom(const CraneParameters& crane) {
  HouseAndBoom result;
  if (crane.boom.element_count == 0) {
    result = {.mass = Eigen::MatrixXd::Constant(1, 1, driven_inertia(crane)),
              .stiffness = Eigen::MatrixXd::Zero(1, 1)};
  } else {
    const BoomMatrices boom = assemble_boom(crane.boom);
    const Eigen::Vector3d pivot = pivot_motion(crane.boom);
    result = {.mass = merge_pivot(boom.mass, pivot), .stiffness = merge_pivot(boom.stiffness, pivot)};
    result.mass(0, 0) += crane.house.inertia;
  }
  return house_root(crane.house) == 0 ? result : with_ring(result, crane.house);
}

}  // namespace

double driven_inertia(const CraneParameters& crane) {
  return crane.house.inertia + rigid_boom_inertia(crane.boom);
}

double rigid_inertia(const CraneParameters& crane) {
  return crane.drive.group_count * group_inertia(crane.drive) + driven_inertia(crane);
}

GearContact gear_contact(const CraneParameters& crane) {
  return gear_contact(crane.drive, driven_inertia(crane));
}

CraneMatrices assemble_crane(const CraneParameters& crane, GearState gears) {
  const HouseAndBoom boom = assemble_house_and_boom(crane);
  const int groups = crane.drive.is_rigid ? 0 : crane.drive.group_count;
  const int boom_size = static_cast<int>(boom.mass.rows());
  const bool has_load = crane.load.mass > 0.0;
  const bool has_rod = has_load && crane.load.rod_length > 0.0;

  CraneMatrices result;
  CraneIndices& at = result.at;
  at.group_count = groups;
  at.house = groups;
  at.size = groups + boom_size;
  if (crane.boom.element_count > 0) {
    at.tip = at.size - 3;
    at.tip_twist = at.size - 1;
  }
  if (has_load) at.rope = at.size++;
  if (has_rod) at.rod = at.size++;

  result.mass = Eigen::MatrixXd::Zero(at.size, at.size);
  result.stiffness = Eigen::MatrixXd::Zero(at.size, at.size);
  result.damping = Eigen::MatrixXd::Zero(at.size, at.size);
  result.mass.block(at.house, at.house, boom_size, boom_size) = boom.mass;
  result.stiffness.block(at.house, at.house, boom_size, boom_size) = boom.stiffness;
  if (crane.boom.element_count > 0) {
    result.damping.block(at.house, at.house, boom_size, boom_size) =
        boom_damping_coefficient(crane.boom) * boom.stiffness;
  }

  const GearContact gear = gear_contact(crane);
  result.mass.topLeftCorner(groups + 1, groups + 1) +=
      drive_mass_matrix(groups, group_inertia(crane.drive), 0.0);
  if (crane.drive.is_rigid) {
    result.mass(at.house, at.house) += crane.drive.group_count * group_inertia(crane.drive);
  } else if (gears == GearState::kClosed) {
    result.stiffness.topLeftCorner(groups + 1, groups + 1) += drive_stiffness_matrix(groups, gear.stiffness);
    result.damping.topLeftCorner(groups + 1, groups + 1) += drive_stiffness_matrix(groups, gear.damping);
  }

  if (has_load) {
    // (3.18), (3.19) on [y_b, beta_1, beta_2]; the damping acts on the rope's rotation against the tip and
    // on the rod's, so beta_1 = (y_1 - y_b) / L_wr brings LoadOnSpring's matrix over.
    const int lines = has_rod ? 3 : 2;
    Eigen::MatrixXd place = Eigen::MatrixXd::Zero(lines, at.size);
    if (at.tip >= 0) {
      place(0, at.tip) = 1.0;
      place(0, at.tip_twist) = crane.boom.jib_eccentricity;
    } else {
      place(0, at.house + house_root(crane.house)) = sheave_radius(crane.boom);
    }
    place(1, at.rope) = 1.0;
    if (has_rod) place(2, at.rod) = 1.0;
    Eigen::Matrix3d damping = Eigen::Matrix3d::Zero();
    const Eigen::Matrix2d scale = Eigen::Vector2d(crane.load.rope_length, 1.0).asDiagonal();
    damping.bottomRightCorner<2, 2>() = scale * load_on_spring(crane.load).damping * scale;
    const auto add = [&](Eigen::MatrixXd& matrix, const Eigen::Matrix3d& load) {
      matrix += place.transpose() * load.topLeftCorner(lines, lines) * place;
    };
    add(result.mass, load_mass_matrix(crane.load));
    add(result.stiffness, load_stiffness_matrix(crane.load));
    add(result.damping, damping);
  }
  return result;
}

FreeHouseModes free_house_modes(const CraneParameters& crane) {
  const HouseAndBoom assembled = assemble_house_and_boom(crane);
  const int size = static_cast<int>(assembled.mass.rows());
  const int elements = crane.boom.element_count;
  const BoomParameters& boom = crane.boom;
  const int root = house_root(crane.house);

  // The rigid rotation is known; the solver's lowest mode only approximates it.
  Eigen::VectorXd rigid = Eigen::VectorXd::Zero(size);
  rigid(0) = rigid(root) = 1.0;
  for (int node = 1; node <= elements; ++node) {
    const BoomPoint point = point_of_node(boom, node);
    rigid(root + 3 * node - 2) = point.radius;
    rigid(root + 3 * node - 1) = std::cos(point.angle);
    rigid(root + 3 * node) = std::sin(point.angle);
  }
  rigid /= std::sqrt(rigid.dot(assembled.mass * rigid));

  Eigen::MatrixXd shapes(size, size);
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(size);
  shapes.col(0) = rigid;
  if (size > 1) {
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(assembled.stiffness,
                                                                           assembled.mass);
    squares.tail(size - 1) = solver.eigenvalues().tail(size - 1);
    shapes.rightCols(size - 1) = solver.eigenvectors().rightCols(size - 1);
  }

  const double damping = elements > 0 ? boom_damping_coefficient(boom) : 0.0;
  int kept = size;
  if (boom.highest_frequency > 0.0) {
    const double highest = 2.0 * std::numbers::pi * boom.highest_frequency;
    while (kept > 1 && squares(kept - 1) > highest * highest) --kept;
  }

  FreeHouseModes modes;
  modes.shear = Eigen::MatrixXd::Zero(elements, kept);
  std::vector<double> rigidity;
  if (elements > 0) rigidity = assemble_boom(boom).element_rigidity;
  const int before = elements_before_knuckle(boom);

  for (int k = 0; k < kept; ++k) {
    Eigen::VectorXd shape = shapes.col(k);
    // Node values [y, phi, psi] with the pivot node written out (3.16).
    const auto write_nodes = [&] {
      Eigen::VectorXd nodes(3 * (elements + 1));
      nodes.head<3>() = pivot_motion(boom) * shape(root);
      nodes.tail(size - 1 - root) = shape.tail(size - 1 - root);
      return nodes;
    };
    Eigen::VectorXd nodes = write_nodes();
    const double tip = elements > 0 ? nodes(3 * elements) : tip_radius(boom) * shape(root);
    const double scale = shape.cwiseAbs().maxCoeff();
    const double side = std::abs(tip) > 1e-9 * scale ? tip : shape(root);
    if (side < 0.0) {
      shape = -shape;
      nodes = write_nodes();
    }
    double integral = 0.0;
    double middle = 0.0;
    for (int e = 0; e < elements; ++e) {
      const double h = length_of_element(boom, e);
      const double y1 = nodes(3 * e), phi1 = e == before ? behind_knuckle(boom).row(0).dot(nodes.segment<2>(3 * e + 1)) : nodes(3 * e + 1);
      const double y2 = nodes(3 * e + 3), phi2 = nodes(3 * e + 4);
      // Cubic shape functions of the element: its integral, its third derivative, its value at half length.
      integral += h * (0.5 * (y1 + y2) + h * (phi1 - phi2) / 12.0);
      modes.shear(e, k) = rigidity[static_cast<std::size_t>(e)] / (h * h * h) *
                          (12.0 * (y1 - y2) + 6.0 * h * (phi1 + phi2));
      const double s = before == elements ? 0.5 * elements - e : (0.5 - share_of_node(boom, e)) * boom.length / h;
      if (s >= 0.0 && (s < 1.0 || (s == 1.0 && e + 1 == elements))) {
        const double s2 = s * s, s3 = s2 * s;
        middle = (1 - 3 * s2 + 2 * s3) * y1 + h * (s - 2 * s2 + s3) * phi1 + (3 * s2 - 2 * s3) * y2 +
                 h * (s3 - s2) * phi2;
      }
    }
    if (elements == 0) {
      middle = boom_point(boom, 0.5).radius * shape(root);
      integral = boom.length * middle;
      if (boom.knuckle_position > 0.0) {
        integral = 0.0;
        for (const BoomPiece& piece : straight_pieces(boom)) {
          integral += boom.length * (piece.to - piece.from) * boom_point(boom, 0.5 * (piece.from + piece.to)).radius * shape(root);
        }
      }
    }
    if (k == 0) modes.shear.col(0).setZero();
    modes.frequency.push_back(std::sqrt(std::max(0.0, squares(k))));
    modes.damping_rate.push_back(damping * squares(k));
    modes.house.push_back(shape(0));
    modes.pivot.push_back(shape(root));
    modes.tip.push_back(elements > 0 ? nodes(3 * elements) + boom.jib_eccentricity * nodes(3 * elements + 2)
                                     : sheave_radius(boom) * shape(root));
    modes.middle.push_back(middle);
    modes.tip_twist.push_back(elements > 0 ? nodes(3 * elements + 2) : std::sin(boom_point(boom, 1.0).angle) * shape(root));
    modes.uniform_load.push_back(integral);
  }
  return modes;
}

}  // namespace slewlab::sim
