#include "sim/drive/crane_plant.h"

#include <algorithm>
#include <cmath>

namespace slewlab::sim {
namespace {

// drive_state of PLANT_STATUS.
constexpr std::int8_t kReady = 0;
constexpr std::int8_t kRunning = 1;

}  // namespace

CranePlant::CranePlant(const CraneParameters& crane, double step)
    : model_(make_plant_model(crane, step)), workspace_(make_plant_workspace(model_)), state_(make_plant_state(model_)) {}

void CranePlant::read_encoder(msgs::Encoder& message) {
  const PlantReadings readings = read(model_, state_);
  const auto groups = static_cast<std::size_t>(model_.group_count);
  message.group_count = model_.group_count;
  message.shaft_speed.assign(readings.shaft_speed.begin(), readings.shaft_speed.begin() + groups);
  message.shaft_position.assign(readings.shaft_position.begin(), readings.shaft_position.begin() + groups);
}

void CranePlant::command(const msgs::Torque& message) {
  const auto finite = [](double torque) { return std::isfinite(torque); };
  enabled_ = message.enable && message.group_count == model_.group_count &&
             std::all_of(message.motor_torque.begin(), message.motor_torque.end(), finite);
  for (int group = 0; group < model_.group_count; ++group) {
    input_.motor_torque[group] = enabled_ ? message.motor_torque[group] : 0.0;
  }
}

void CranePlant::step() { sim::step(model_, workspace_, input_, state_); }

void CranePlant::read_sensors(msgs::Sensors& message) {
  const PlantReadings readings = read(model_, state_);
  message.house_acceleration = readings.house_acceleration;
  message.pivot_acceleration = readings.pivot_acceleration;
  message.middle_acceleration = readings.middle_acceleration;
  message.tip_acceleration = readings.tip_acceleration;
  message.slew_angle = readings.slew_angle;
}

void CranePlant::read_truth(msgs::Truth& message) {
  const auto groups = static_cast<std::size_t>(model_.group_count);
  message.group_count = model_.group_count;
  message.gearbox_torque.assign(state_.gear_torque.begin(), state_.gear_torque.begin() + groups);
  message.gear_deflection.resize(groups);
  for (int group = 0; group < model_.group_count; ++group) {
    message.gear_deflection[group] = gear_deflection(state_, group);
  }
  message.play_crossings.assign(state_.play_crossings.begin(), state_.play_crossings.begin() + groups);
  message.house_speed = state_.house_speed;
  message.tip_displacement = state_.tip_displacement;
  message.tip_velocity = state_.tip_velocity;
  message.rope_angle = rope_angle(model_, state_);
  message.rod_angle = rod_angle(model_, state_);
  message.mechanical_energy = mechanical_energy(model_, state_);
  message.supplied_work = state_.supplied_work;
  message.element_count = model_.parameters.boom.element_count;
  message.shear_force.resize(static_cast<std::size_t>(message.element_count));
  shear_forces(model_, state_, message.shear_force.data());
  message.mode_count = model_.mode_count;
  message.modal_energy.resize(static_cast<std::size_t>(message.mode_count));
  for (int mode = 0; mode < model_.mode_count; ++mode) message.modal_energy[mode] = modal_energy(model_, state_, mode);
}

void CranePlant::read_status(msgs::PlantStatus& message) {
  message.drive_state = enabled_ ? kRunning : kReady;
  message.fault_count = 0;
  message.bin_count = 0;
}

}  // namespace slewlab::sim
