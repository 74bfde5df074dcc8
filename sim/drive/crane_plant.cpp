#include "sim/drive/crane_plant.h"

#include <cmath>
#include <limits>
#include <utility>

#include "sim/machine/description.h"

namespace slewlab::sim {

CranePlant::CranePlant(const MachineSettings& machine, const DriveRun& run)
    : CranePlant(make_machine(machine), machine.drive_protection, run) {}

CranePlant::CranePlant(Machine machine, const DriveProtectionSettings& protection, const DriveRun& run)
    : protection_(protection), run_(run), step_(std::llround(machine.model.step * 1e9)), machine_(std::move(machine)) {
  for (std::size_t k = 0; k < kSensorCount; ++k) {
    is_fitted_[k] = has_place(machine_.model.parameters, place_named(msgs::kSensorFields<PlantReadings>[k].place));
  }
}

DriveMoment CranePlant::moment() const {
  DriveMoment moment;
  moment.time = machine_.state.step_count * step_;
  for (int group = 0; group < machine_.model.group_count; ++group) {
    moment.shaft_speed[group] = machine_.state.motor_speed[group] * machine_.model.ratio;
  }
  moment.main_power = conditions_.main_power;
  moment.group_lost = conditions_.group_lost;
  return moment;
}

void CranePlant::read_encoder(msgs::Encoder& message) {
  const PlantReadings readings = read(machine_);
  const auto groups = static_cast<std::size_t>(machine_.model.group_count);
  message.group_count = machine_.model.group_count;
  message.shaft_speed.assign(readings.shaft_speed.begin(), readings.shaft_speed.begin() + groups);
  message.shaft_position.assign(readings.shaft_position.begin(), readings.shaft_position.begin() + groups);
}

void CranePlant::begin_cycle(std::int64_t encoder_sequence) { sim::begin_cycle(drive_, encoder_sequence); }

void CranePlant::receive(msgs::DecodeStatus status, const msgs::Torque& message) {
  sim::receive(protection_, run_, drive_, moment(), status, message);
}

void CranePlant::step(const PlantConditions& conditions) {
  conditions_ = conditions;
  sim::step(machine_, drive_command(protection_, run_, drive_, moment(), step_));
}

void CranePlant::read_sensors(msgs::Sensors& message) {
  const PlantReadings readings = read(machine_);
  for (std::size_t k = 0; k < kSensorCount; ++k) {
    message.*msgs::kSensorFields<msgs::Sensors>[k].value =
        is_fitted_[k] ? readings.*msgs::kSensorFields<PlantReadings>[k].value : std::numeric_limits<double>::quiet_NaN();
  }
}

void CranePlant::read_truth(msgs::Truth& message) {
  const auto groups = static_cast<std::size_t>(machine_.model.group_count);
  message.group_count = machine_.model.group_count;
  message.gearbox_torque.assign(machine_.state.gear_torque.begin(), machine_.state.gear_torque.begin() + groups);
  message.gear_deflection.resize(groups);
  for (int group = 0; group < machine_.model.group_count; ++group) {
    message.gear_deflection[group] = gear_deflection(machine_.state, group);
  }
  message.play_crossings.assign(machine_.state.play_crossings.begin(), machine_.state.play_crossings.begin() + groups);
  message.house_speed = machine_.state.house_speed;
  message.tip_displacement = machine_.state.tip_displacement;
  message.tip_velocity = machine_.state.tip_velocity;
  message.rope_angle = rope_angle(machine_);
  message.rod_angle = rod_angle(machine_.model, machine_.state);
  message.mechanical_energy = mechanical_energy(machine_.model, machine_.state);
  message.supplied_work = machine_.state.supplied_work;
  message.element_count = machine_.model.parameters.boom.element_count;
  message.shear_force.resize(static_cast<std::size_t>(message.element_count));
  shear_forces(machine_.model, machine_.state, message.shear_force.data());
  message.mode_count = machine_.model.mode_count;
  message.modal_energy.resize(static_cast<std::size_t>(message.mode_count));
  for (int mode = 0; mode < machine_.model.mode_count; ++mode) message.modal_energy[mode] = modal_energy(machine_.model, machine_.state, mode);
}

void CranePlant::read_status(msgs::PlantStatus& message) {
  message.drive_state = static_cast<std::int8_t>(drive_.state);
  message.trip_cause = static_cast<std::int8_t>(drive_.trip_cause);
  message.trip_time = drive_.trip_time;
  message.fault_count = kDriveFaultCount;
  message.faults.assign(drive_.faults.begin(), drive_.faults.end());
  message.stale_commands = drive_.stale_commands;
  message.missed_deadlines = 0;
  message.bin_count = 0;
}

bool CranePlant::read_motion(msgs::Motion& message) {
  const CraneMotion& motion = machine_.motion;
  if (!motion.moves) return false;
  const double time = time_of(machine_);
  message.rope_length = rope_length(motion, time);
  message.hoisting_speed = motion.hoisting.at(time).speed;
  message.boom_angle = boom_angle(motion, time);
  message.luffing_speed = motion.luffing.at(time).speed;
  const MotionState travelling = motion.travelling.at(time);
  message.travelled = travelling.way;
  message.travelling_speed = travelling.speed;
  return true;
}

std::optional<Divergence> CranePlant::divergence() const {
  // [m/s], and [rad/s] at a metre from the axis: of light. What is faster, or no number, is no machine's.
  constexpr double kFastest = 3e8;
  const auto possible = [](double speed) { return std::fabs(speed) <= kFastest; };  // false for what is no number
  const PlantState& state = machine_.state;
  for (int group = 0; group < machine_.model.group_count; ++group) {
    if (!possible(state.motor_speed[group])) return Divergence{"speed of a motor group, on the slew axis", "rad/s", state.motor_speed[group]};
  }
  if (!possible(state.house_speed)) return Divergence{"slewing speed", "rad/s", state.house_speed};
  if (!possible(state.tip_velocity)) return Divergence{"velocity of the boom's tip", "m/s", state.tip_velocity};
  if (machine_.model.has_load) {
    if (!std::isfinite(state.rope_force)) return Divergence{"force of the rope on the boom's tip", "N", state.rope_force};
    for (const double velocity : state.load_v) {
      if (!std::isfinite(velocity)) return Divergence{"velocity of the load's swing, times the root of its mass", "m/s kg^0.5", velocity};
    }
  }
  return std::nullopt;
}

}  // namespace slewlab::sim
