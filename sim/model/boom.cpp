#include "sim/model/boom.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "sim/model/box_section.h"
#include "sim/model/cannot_be_built.h"

namespace slewlab::sim {

namespace {

// Integral of the square of a line that runs from `left` to `right` over a unit length.
double mean_square(double left, double right) { return (left * left + left * right + right * right) / 3.0; }

struct Span {
  BoomStation from;
  BoomStation to;
};

// The straight pieces of the profile between two positions.
std::vector<Span> spans_between(const BoomParameters& boom, double from_position, double to_position) {
  std::vector<double> cuts{from_position};
  for (const BoomStation& station : boom.profile) {
    if (station.position > from_position && station.position < to_position) cuts.push_back(station.position);
  }
  cuts.push_back(to_position);
  std::vector<Span> spans;
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    spans.push_back({station_at(boom, cuts[i]), station_at(boom, cuts[i + 1])});
  }
  return spans;
}

bool is_box(const BoomParameters& boom) { return boom.type == BoomType::box_girder || boom.type == BoomType::knuckle; }

BoxSection box_at(const BoomParameters& boom, double position) {
  const BoomStation station = station_at(boom, position);
  return {2.0 * station.half_width, 2.0 * station.half_height, boom.side_plate, boom.flange_plate};
}

// Mean of a number of the section over a stretch; Gauss's three points in each straight piece, exact up to the fifth power of the position.
template <class OfSection>
double mean_of_box(const BoomParameters& boom, double from_position, double to_position, const OfSection& of_section) {
  constexpr double kReach = 0.77459666924148338;  // sqrt(3/5)
  double integral = 0.0;
  for (const Span& span : spans_between(boom, from_position, to_position)) {
    const double middle = 0.5 * (span.from.position + span.to.position), half = 0.5 * (span.to.position - span.from.position);
    integral += half / 9.0 *
                (5.0 * of_section(box_at(boom, middle - kReach * half)) + 8.0 * of_section(box_at(boom, middle)) +
                 5.0 * of_section(box_at(boom, middle + kReach * half)));
  }
  return integral / (to_position - from_position);
}

}  // namespace

double mean_polar_mass(const BoomParameters& boom, double from_position, double to_position) {
  if (is_box(boom)) return boom.mass / boom.length * mean_of_box(boom, from_position, to_position, polar_radius_square);
  double integral = 0.0;
  for (const Span& span : spans_between(boom, from_position, to_position)) {
    integral += (mean_square(span.from.half_width, span.to.half_width) +
                 mean_square(span.from.half_height, span.to.half_height)) *
                (span.to.position - span.from.position);
  }
  return boom.mass / boom.length * integral / (to_position - from_position);
}

double second_moment_of_area(double outer_diameter, double inner_diameter, double half_width) {
  const double d2 = outer_diameter * outer_diameter;
  const double i2 = inner_diameter * inner_diameter;
  return std::numbers::pi / 16.0 * (d2 * d2 - i2 * i2) +
         std::numbers::pi * half_width * half_width * (d2 - i2);
}

BoomStation station_at(const BoomParameters& boom, double position) {
  if (boom.profile.empty()) throw std::invalid_argument("boom profile has no stations");
  const auto after = std::find_if(boom.profile.begin(), boom.profile.end(),
                                  [&](const BoomStation& s) { return s.position >= position; });
  if (after == boom.profile.begin()) return {position, after->half_width, after->half_height};
  if (after == boom.profile.end()) {
    return {position, boom.profile.back().half_width, boom.profile.back().half_height};
  }
  const BoomStation& left = *(after - 1);
  const double share = (position - left.position) / (after->position - left.position);
  return {position, left.half_width + share * (after->half_width - left.half_width),
          left.half_height + share * (after->half_height - left.half_height)};
}

double mean_second_moment(const BoomParameters& boom, double from_position, double to_position) {
  if (is_box(boom)) return mean_of_box(boom, from_position, to_position, lateral_second_moment);
  double square = 0.0;
  for (const Span& span : spans_between(boom, from_position, to_position)) {
    square += mean_square(span.from.half_width, span.to.half_width) * (span.to.position - span.from.position);
  }
  // (2.11) is linear in the square of the half width, so the mean of one gives the mean of the other.
  const double moment = second_moment_of_area(boom.chord_outer_diameter, boom.chord_inner_diameter,
                                              std::sqrt(square / (to_position - from_position)));
  return boom.type == BoomType::a_frame ? 0.5 * moment : moment;
}

double mean_torsional_rigidity(const BoomParameters& boom, double from_position, double to_position) {
  if (!is_box(boom)) return boom.shear_modulus * boom.torsion_constant;
  return boom.shear_modulus /
         mean_of_box(boom, from_position, to_position, [](const BoxSection& box) { return 1.0 / torsion_constant(box); });
}

int elements_before_knuckle(const BoomParameters& boom) {
  const int count = boom.element_count;
  if (boom.knuckle_position == 0.0 || count < 2) return count;
  return std::clamp(static_cast<int>(std::lround(boom.knuckle_position * count)), 1, count - 1);
}

double length_of_element(const BoomParameters& boom, int element) {
  const int count = boom.element_count, before = elements_before_knuckle(boom);
  if (before == count) return boom.length / count;
  return element < before ? boom.length * boom.knuckle_position / before : boom.length * (1.0 - boom.knuckle_position) / (count - before);
}

double share_of_node(const BoomParameters& boom, int node) {
  const int count = boom.element_count, before = elements_before_knuckle(boom);
  if (before == count) return static_cast<double>(node) / count;
  if (node <= before) return boom.knuckle_position * node / before;
  return boom.knuckle_position + (1.0 - boom.knuckle_position) * (node - before) / (count - before);
}

Eigen::Matrix2d behind_knuckle(const BoomParameters& boom) {
  // A turn with phi about the boom's normal and psi about its axis, seen from axes that lie `bend` higher.
  const double bend = boom.knuckle_angle - boom.angle;
  Eigen::Matrix2d turned;
  turned << std::cos(bend), -std::sin(bend), std::sin(bend), std::cos(bend);
  return turned;
}

BoomPoint point_of_node(const BoomParameters& boom, int node) {
  if (boom.knuckle_position > 0.0) return boom_point(boom, share_of_node(boom, node));
  const double x = boom.length * node / boom.element_count;
  return {boom.pivot_radius + x * std::cos(boom.angle), x * std::sin(boom.angle), boom.angle};
}

std::vector<BoomPiece> straight_pieces(const BoomParameters& boom) {
  if (boom.knuckle_position == 0.0) return {{0.0, 1.0, boom.angle}};
  return {{0.0, boom.knuckle_position, boom.angle}, {boom.knuckle_position, 1.0, boom.knuckle_angle}};
}

BoomPoint boom_point(const BoomParameters& boom, double share) {
  const double x = boom.length * share;
  if (boom.knuckle_position == 0.0 || share <= boom.knuckle_position) {
    return {boom.pivot_radius + x * std::cos(boom.angle), x * std::sin(boom.angle), boom.angle};
  }
  const double inner = boom.length * boom.knuckle_position, outer = x - inner;
  return {boom.pivot_radius + inner * std::cos(boom.angle) + outer * std::cos(boom.knuckle_angle),
          inner * std::sin(boom.angle) + outer * std::sin(boom.knuckle_angle), boom.knuckle_angle};
}

namespace {

// A cylinder from its lower end to the boom.
struct CylinderLine {
  double length;  // [m]
  double sine;    // of the angle between cylinder and boom, positive where the lower end lies below the boom
};

CylinderLine cylinder_line(const BoomParameters& boom, double angle) {
  const double along = boom.length * boom.cylinders.position, c = std::cos(angle), s = std::sin(angle);
  const double level = boom.pivot_radius + along * c - boom.cylinders.base_radius;
  const double up = along * s - boom.cylinders.base_height;
  const double length = std::hypot(level, up);
  return {length, (c * up - s * level) / length};
}

}  // namespace

double cylinder_lever(const BoomParameters& boom, double angle) { return boom.length * boom.cylinders.position * cylinder_line(boom, angle).sine; }

double oil_column(const BoomParameters& boom, double angle) {
  return boom.cylinders.oil_column + cylinder_line(boom, angle).length - cylinder_line(boom, boom.angle).length;
}

double cylinder_force(const BoomParameters& boom, double at_tip) {
  const double moment = kGravity * std::cos(boom.angle) * boom.length * (0.5 * boom.mass + at_tip);
  return moment / cylinder_lever(boom, boom.angle);
}

namespace {

// With the oil and the weight's lever of an angle.
LuffingCylinders cylinders_at(const BoomParameters& boom, double angle) {
  LuffingCylinders cylinders = boom.cylinders;
  if (angle == boom.angle) return cylinders;
  if (cylinders.oil_column > 0.0) {
    cylinders.oil_column = oil_column(boom, angle);
    cylinders.stiffness *= boom.cylinders.oil_column / cylinders.oil_column;
  }
  cylinders.force *= std::cos(angle) / std::cos(boom.angle) * cylinder_line(boom, boom.angle).sine / cylinder_line(boom, angle).sine;
  return cylinders;
}

}  // namespace

CylinderHold cylinder_hold(const BoomParameters& boom, double angle) {
  if (boom.cylinders.stiffness == 0.0) return {};
  const LuffingCylinders cylinders = cylinders_at(boom, angle);
  const CylinderLine line = cylinder_line(boom, angle);
  return {.torsion = 0.5 * cylinders.stiffness * line.sine * line.sine * cylinders.spacing * cylinders.spacing, .lateral = -cylinders.force / line.length};
}

BoomParameters raised_boom(BoomParameters boom, double by) {
  if (boom.cylinders.stiffness != 0.0) boom.cylinders = cylinders_at(boom, boom.angle + by);
  boom.angle += by;
  if (boom.knuckle_position != 0.0) boom.knuckle_angle += by;
  return boom;
}

double lateral_stiffness(double youngs_modulus, double second_moment, double length) {
  return 3.0 * youngs_modulus * second_moment / (length * length * length);
}

double boom_inertia(const BoomParameters& boom, double mean_half_width) {
  const double projected = boom.length * std::cos(boom.angle);
  const double centre = boom.pivot_radius + 0.5 * projected;
  return boom.mass * (4.0 * mean_half_width * mean_half_width + projected * projected) / 12.0 +
         boom.mass * centre * centre;
}

namespace {

double rigid_inertia_of_piece(const BoomParameters& boom, const BoomPiece& piece) {
  const double share = piece.to - piece.from;
  const double mass = boom.mass * share, projected = boom.length * share * std::cos(piece.angle);
  const double centre = boom_point(boom, piece.from).radius + 0.5 * projected, twist = std::sin(piece.angle);
  return mass * (projected * projected / 12.0 + centre * centre) +
         mean_polar_mass(boom, piece.from, piece.to) * boom.length * share * twist * twist;
}

}  // namespace

double rigid_boom_inertia(const BoomParameters& boom) {
  if (boom.mass == 0.0) return 0.0;
  if (boom.knuckle_position > 0.0) {
    double inertia = boom.jib_mass * sheave_radius(boom) * sheave_radius(boom);
    for (const BoomPiece& piece : straight_pieces(boom)) inertia += rigid_inertia_of_piece(boom, piece);
    return inertia;
  }
  const double projected = boom.length * std::cos(boom.angle);
  const double centre = boom.pivot_radius + 0.5 * projected;
  const double twist = std::sin(boom.angle);
  return boom.mass * (projected * projected / 12.0 + centre * centre) +
         mean_polar_mass(boom, 0.0, 1.0) * boom.length * twist * twist +
         boom.jib_mass * sheave_radius(boom) * sheave_radius(boom);
}

double clamped_frequency(int mode, double youngs_modulus, double second_moment, double mass, double length) {
  constexpr std::array<double, 3> kEigenvalue{1.875, 4.694, 7.855};  // y_t, thesis below (2.14)
  const double y = kEigenvalue.at(static_cast<std::size_t>(mode - 1));
  return y * y / (2.0 * std::numbers::pi) *
         std::sqrt(youngs_modulus * second_moment / (mass * length * length * length));
}

double compression_factor(double compression, double critical_force) {
  return std::sqrt(1.0 - compression / critical_force);
}

double critical_buckling_force(double youngs_modulus, double second_moment, double length) {
  return std::numbers::pi * std::numbers::pi * youngs_modulus * second_moment / (length * length);
}

Eigen::Matrix4d bending_mass(double mass_per_length, double length) {
  const double l = length;
  Eigen::Matrix4d matrix;
  matrix << 156, 22 * l, 54, -13 * l,            //
      22 * l, 4 * l * l, 13 * l, -3 * l * l,     //
      54, 13 * l, 156, -22 * l,                  //
      -13 * l, -3 * l * l, -22 * l, 4 * l * l;
  return mass_per_length * l / 420.0 * matrix;
}

Eigen::Matrix4d bending_stiffness(double bending_rigidity, double length) {
  const double l = length;
  Eigen::Matrix4d matrix;
  matrix << 12, 6 * l, -12, 6 * l,            //
      6 * l, 4 * l * l, -6 * l, 2 * l * l,    //
      -12, -6 * l, 12, -6 * l,                //
      6 * l, 2 * l * l, -6 * l, 4 * l * l;
  return bending_rigidity / (l * l * l) * matrix;
}

Eigen::Matrix2d torsion_mass(double polar_mass_per_length, double length) {
  Eigen::Matrix2d matrix;
  matrix << 2, 1, 1, 2;
  return polar_mass_per_length * length / 6.0 * matrix;
}

Eigen::Matrix2d torsion_stiffness(double torsional_rigidity, double length) {
  Eigen::Matrix2d matrix;
  matrix << 1, -1, -1, 1;
  return torsional_rigidity / length * matrix;
}

namespace {

Matrix6d combine(const Eigen::Matrix4d& bending, const Eigen::Matrix2d& torsion) {
  constexpr std::array<int, 4> kBending{0, 1, 3, 4};
  constexpr std::array<int, 2> kTorsion{2, 5};
  Matrix6d matrix = Matrix6d::Zero();
  matrix(kBending, kBending) = bending;
  matrix(kTorsion, kTorsion) = torsion;
  return matrix;
}

}  // namespace

Matrix6d element_mass(double mass_per_length, double polar_mass_per_length, double length) {
  return combine(bending_mass(mass_per_length, length), torsion_mass(polar_mass_per_length, length));
}

Matrix6d element_stiffness(double bending_rigidity, double torsional_rigidity, double length) {
  return combine(bending_stiffness(bending_rigidity, length), torsion_stiffness(torsional_rigidity, length));
}

double stiffness_damping_coefficient(double damping_ratio, double first_frequency, double second_frequency) {
  return 2.0 * damping_ratio / (first_frequency + second_frequency);
}

double stiffness_damping_coefficient_as_printed(double damping_ratio, double first_frequency,
                                                double second_frequency) {
  return 2.0 * damping_ratio * (second_frequency - first_frequency) /
         (second_frequency * second_frequency + first_frequency * first_frequency);
}

CylinderPlace cylinder_place(const BoomParameters& boom) {
  const double at = boom.cylinders.position * boom.element_count;
  const int e = std::min(static_cast<int>(at), boom.element_count - 1);
  const double s = at - e, h = boom.length / boom.element_count, s2 = s * s, s3 = s2 * s;
  CylinderPlace place{.twist = Eigen::VectorXd::Zero(3 * (boom.element_count + 1)), .deflection = Eigen::VectorXd::Zero(3 * (boom.element_count + 1))};
  place.twist(3 * e + 2) += 1.0 - s;
  place.twist(3 * e + 5) += s;
  place.twist(2) -= 1.0;
  place.deflection(3 * e) += 1.0 - 3.0 * s2 + 2.0 * s3;
  place.deflection(3 * e + 1) += h * (s - 2.0 * s2 + s3);
  place.deflection(3 * e + 3) += 3.0 * s2 - 2.0 * s3;
  place.deflection(3 * e + 4) += h * (s3 - s2);
  place.deflection(0) -= 1.0;
  place.deflection(1) -= boom.length * boom.cylinders.position;
  return place;
}

BoomMatrices assemble_boom(const BoomParameters& boom) {
  const int count = boom.element_count;
  if (count < 1) throw std::invalid_argument("a boom of beam elements needs at least one element");
  if (boom.knuckle_position > 0.0 && count < 2) throw CannotBeBuilt("a boom with a knuckle needs two elements or more");
  const int size = 3 * (count + 1);
  BoomMatrices matrices{.mass = Eigen::MatrixXd::Zero(size, size),
                        .stiffness = Eigen::MatrixXd::Zero(size, size),
                        .element_rigidity = {},
                        .element_length = boom.length / count};
  const double mass_per_length = boom.mass / boom.length;
  const int before = elements_before_knuckle(boom);
  for (int e = 0; e < count; ++e) {
    const double from = share_of_node(boom, e);
    const double to = share_of_node(boom, e + 1);
    const double length = length_of_element(boom, e);
    const double rigidity = boom.youngs_modulus * mean_second_moment(boom, from, to);
    matrices.element_rigidity.push_back(rigidity);
    Matrix6d mass = element_mass(mass_per_length, mean_polar_mass(boom, from, to), length);
    Matrix6d stiffness = element_stiffness(rigidity, mean_torsional_rigidity(boom, from, to), length);
    if (e > 0 && e == before) {
      Matrix6d turned = Matrix6d::Identity();
      turned.block<2, 2>(1, 1) = behind_knuckle(boom);
      mass = turned.transpose() * mass * turned;
      stiffness = turned.transpose() * stiffness * turned;
    }
    matrices.mass.block<6, 6>(3 * e, 3 * e) += mass;
    matrices.stiffness.block<6, 6>(3 * e, 3 * e) += stiffness;
  }
  if (boom.cylinders.stiffness > 0.0) {
    const CylinderHold hold = cylinder_hold(boom, boom.angle);
    const CylinderPlace place = cylinder_place(boom);
    matrices.stiffness += hold.torsion * place.twist * place.twist.transpose() + hold.lateral * place.deflection * place.deflection.transpose();
  }
  // The jib moves with y + e psi of the tip.
  const double e = boom.jib_eccentricity;
  matrices.mass(size - 3, size - 3) += boom.jib_mass;
  matrices.mass(size - 3, size - 1) += boom.jib_mass * e;
  matrices.mass(size - 1, size - 3) += boom.jib_mass * e;
  matrices.mass(size - 1, size - 1) += boom.jib_mass * e * e;
  return matrices;
}

Eigen::Vector3d pivot_motion(const BoomParameters& boom) {
  return {boom.pivot_radius, std::cos(boom.angle), std::sin(boom.angle)};
}

Eigen::MatrixXd merge_pivot(const Eigen::MatrixXd& boom_matrix, const Eigen::Vector3d& pivot) {
  const Eigen::Index rest = boom_matrix.rows() - 3;
  Eigen::MatrixXd merged(rest + 1, rest + 1);
  merged(0, 0) = pivot.dot(boom_matrix.topLeftCorner<3, 3>() * pivot);
  merged.topRightCorner(1, rest) = pivot.transpose() * boom_matrix.topRightCorner(3, rest);
  merged.bottomLeftCorner(rest, 1) = boom_matrix.bottomLeftCorner(rest, 3) * pivot;
  merged.bottomRightCorner(rest, rest) = boom_matrix.bottomRightCorner(rest, rest);
  return merged;
}

std::vector<double> clamped_bending_frequencies(const BoomParameters& boom) {
  const BoomMatrices matrices = assemble_boom(boom);
  std::vector<int> bending;
  for (int node = 1; node <= boom.element_count; ++node) {
    bending.push_back(3 * node);
    bending.push_back(3 * node + 1);
    if (boom.knuckle_position > 0.0) bending.push_back(3 * node + 2);  // a bent boom twists where it bends
  }
  const Eigen::MatrixXd mass = matrices.mass(bending, bending);
  const Eigen::MatrixXd stiffness = matrices.stiffness(bending, bending);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(stiffness, mass,
                                                                         Eigen::EigenvaluesOnly);
  std::vector<double> frequencies;
  for (const double value : solver.eigenvalues()) frequencies.push_back(std::sqrt(std::max(0.0, value)));
  return frequencies;
}

double boom_damping_coefficient(const BoomParameters& boom) {
  // A mesh of its own, so that the material damps alike in every mesh of the same boom.
  BoomParameters fine = boom;
  fine.element_count = 32;
  const std::vector<double> frequencies = clamped_bending_frequencies(fine);
  return stiffness_damping_coefficient(boom.damping_ratio, frequencies[0], frequencies[1]);
}

double tip_radius(const BoomParameters& boom) { return boom_point(boom, 1.0).radius; }

double sheave_radius(const BoomParameters& boom) {
  return tip_radius(boom) + boom.jib_eccentricity * std::sin(boom_point(boom, 1.0).angle);
}

}  // namespace slewlab::sim
