#include "sim/model/drive_line.h"

#include <cmath>

namespace slewlab::sim {

double total_ratio(const DriveParameters& drive) { return drive.gearbox_ratio * drive.pinion_ratio; }

double drive_inertia(const DriveParameters& drive) {
  return drive.motor_inertia + drive.brake_inertia + drive.gearbox_inertia;
}

double group_inertia(const DriveParameters& drive) {
  const double ratio = total_ratio(drive);
  return drive.motors_per_group * drive_inertia(drive) * ratio * ratio;
}

double group_stiffness(const DriveParameters& drive) {
  return drive.motors_per_group * drive.gearbox_stiffness * drive.pinion_ratio * drive.pinion_ratio;
}

double half_play(const DriveParameters& drive) {
  return 0.5 * (drive.gearbox_play + drive.pinion_play) / drive.pinion_ratio;
}

double series_inertia(double first, double second) { return 1.0 / (1.0 / first + 1.0 / second); }

GearContact gear_contact(const DriveParameters& drive, double driven_inertia) {
  const double stiffness = group_stiffness(drive);
  const double oscillating_inertia =
      series_inertia(drive.group_count * group_inertia(drive), driven_inertia);
  const double critical_damping = 2.0 * std::sqrt(drive.group_count * stiffness * oscillating_inertia);
  return {.stiffness = stiffness,
          .damping = drive.gear_damping_ratio * critical_damping / drive.group_count,
          .half_play = half_play(drive)};
}

Eigen::MatrixXd drive_mass_matrix(int motor_count, double motor_inertia, double house_inertia) {
  Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(motor_count + 1, motor_count + 1);
  mass.diagonal().setConstant(motor_inertia);
  mass(motor_count, motor_count) = house_inertia;
  return mass;
}

Eigen::MatrixXd drive_stiffness_matrix(int motor_count, double gear_stiffness) {
  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(motor_count + 1, motor_count + 1);
  stiffness.diagonal().setConstant(gear_stiffness);
  stiffness.col(motor_count).setConstant(-gear_stiffness);
  stiffness.row(motor_count).setConstant(-gear_stiffness);
  stiffness(motor_count, motor_count) = motor_count * gear_stiffness;
  return stiffness;
}

}  // namespace slewlab::sim
