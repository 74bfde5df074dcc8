#include "sim/model/boom.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

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

// Mean polar mass moment per length [kg m], erratum E3: m (w_y^2 + w_z^2).
double mean_polar_mass(const BoomParameters& boom, double from_position, double to_position) {
  double integral = 0.0;
  for (const Span& span : spans_between(boom, from_position, to_position)) {
    integral += (mean_square(span.from.half_width, span.to.half_width) +
                 mean_square(span.from.half_height, span.to.half_height)) *
                (span.to.position - span.from.position);
  }
  return boom.mass / boom.length * integral / (to_position - from_position);
}

}  // namespace

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
  double square = 0.0;
  for (const Span& span : spans_between(boom, from_position, to_position)) {
    square += mean_square(span.from.half_width, span.to.half_width) * (span.to.position - span.from.position);
  }
  // (2.11) is linear in the square of the half width, so the mean of one gives the mean of the other.
  return second_moment_of_area(boom.chord_outer_diameter, boom.chord_inner_diameter,
                               std::sqrt(square / (to_position - from_position)));
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

double rigid_boom_inertia(const BoomParameters& boom) {
  if (boom.mass == 0.0) return 0.0;
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

BoomMatrices assemble_boom(const BoomParameters& boom) {
  const int count = boom.element_count;
  if (count < 1) throw std::invalid_argument("a boom of beam elements needs at least one element");
  const int size = 3 * (count + 1);
  BoomMatrices matrices{.mass = Eigen::MatrixXd::Zero(size, size),
                        .stiffness = Eigen::MatrixXd::Zero(size, size),
                        .element_rigidity = {},
                        .element_length = boom.length / count};
  const double mass_per_length = boom.mass / boom.length;
  const double torsional_rigidity = boom.shear_modulus * boom.torsion_constant;
  for (int e = 0; e < count; ++e) {
    const double from = static_cast<double>(e) / count;
    const double to = static_cast<double>(e + 1) / count;
    const double rigidity = boom.youngs_modulus * mean_second_moment(boom, from, to);
    matrices.element_rigidity.push_back(rigidity);
    matrices.mass.block<6, 6>(3 * e, 3 * e) +=
        element_mass(mass_per_length, mean_polar_mass(boom, from, to), matrices.element_length);
    matrices.stiffness.block<6, 6>(3 * e, 3 * e) +=
        element_stiffness(rigidity, torsional_rigidity, matrices.element_length);
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

double tip_radius(const BoomParameters& boom) {
  return boom.pivot_radius + boom.length * std::cos(boom.angle);
}

double sheave_radius(const BoomParameters& boom) {
  return tip_radius(boom) + boom.jib_eccentricity * std::sin(boom.angle);
}

}  // namespace slewlab::sim
