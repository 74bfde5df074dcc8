#include "sim/model/load.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <numbers>

namespace slewlab::sim {

double pendulum_frequency(double rope_length) {
  return std::sqrt(kGravity / rope_length) / (2.0 * std::numbers::pi);
}

Eigen::Matrix3d load_mass_matrix(const LoadParameters& load) {
  const double rope = load.rope_length;
  const double rod = load.rod_length;
  Eigen::Matrix3d matrix;
  matrix << 1.0, rope, 0.5 * rod,                      //
      rope, rope * rope, 0.5 * rope * rod,             //
      0.5 * rod, 0.5 * rope * rod, rod * rod / 3.0;
  return load.mass * matrix;
}

Eigen::Matrix3d load_mass_matrix_as_printed(const LoadParameters& load) {
  Eigen::Matrix3d matrix = load_mass_matrix(load);
  matrix(0, 2) = 0.5 * load.mass * load.rope_length;
  matrix(2, 2) = 7.0 / 12.0 * load.mass * load.rod_length * load.rod_length;
  return matrix;
}

Eigen::Matrix3d load_stiffness_matrix(const LoadParameters& load) {
  return Eigen::Vector3d(0.0, load.mass * kGravity * load.rope_length,
                         0.5 * load.mass * kGravity * load.rod_length)
      .asDiagonal();
}

double swing_angle(double speed, double rope_length) {
  return std::acos(1.0 - speed * speed / (2.0 * kGravity * rope_length));
}

double quasi_static_slewing_moment(double inertia, double acceleration, double load_mass, double arm,
                                   double sidelead) {
  return inertia * acceleration + load_mass * kGravity * arm * std::sin(sidelead);
}

LoadOnSpring load_on_spring(const LoadParameters& load) {
  LoadOnSpring result;
  const double m = load.mass;
  const double rod = load.rod_length;
  if (m == 0.0) return result;
  result.rope_stiffness = m * kGravity / load.rope_length;
  if (rod == 0.0) {
    result.mass = Eigen::Vector2d(m, 1.0).asDiagonal();
    result.stiffness = Eigen::Vector2d(result.rope_stiffness, 0.0).asDiagonal();
    result.modes = Eigen::Vector2d(1.0 / std::sqrt(m), 0.0).asDiagonal();
    result.frequency = {std::sqrt(kGravity / load.rope_length), 0.0};
  } else {
    result.mass << m, 0.5 * m * rod, 0.5 * m * rod, m * rod * rod / 3.0;
    result.stiffness = Eigen::Vector2d(result.rope_stiffness, 0.5 * m * kGravity * rod).asDiagonal();
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix2d> solver(result.stiffness, result.mass);
    result.modes = solver.eigenvectors();
    result.frequency = solver.eigenvalues().cwiseSqrt();
  }
  const Eigen::Matrix2d shapes = result.mass * result.modes;
  result.damping = shapes * (2.0 * load.damping_ratio * result.frequency).asDiagonal() * shapes.transpose();
  return result;
}

RopeForces moving_rope(const LoadParameters& load, double length, double upward_acceleration, double difference, double rod_angle) {
  return {.load_force = -(load.mass * ((kGravity + upward_acceleration) / length - kGravity / load.rope_length) * difference),
          .rod_moment = -(0.5 * load.mass * load.rod_length * upward_acceleration * rod_angle)};
}

}  // namespace slewlab::sim
