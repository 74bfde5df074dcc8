#include "tools/replay/open_loop.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

#include "sim/integrate/machine.h"
#include "sim/model/crane.h"

namespace slewlab::tools {
namespace {

constexpr double kNanosecondsPerSecond = 1e9;
constexpr double kOffGrid = 0.25;  // [steps] by which a time stamp may miss the plant's grid, jitter of the recorder's clock aside

std::vector<double> values_or_nothing(const std::vector<msgs::Sensors>& sensors, double msgs::Sensors::* field) {
  std::vector<double> values;
  for (const msgs::Sensors& message : sensors) {
    if (!std::isfinite(message.*field)) return {};
    values.push_back(message.*field);
  }
  return values;
}

// Everything moves as one with the motors.
void start_with(const msgs::Encoder& encoder, const msgs::Torque& torque, sim::Machine& machine) {
  const sim::PlantModel& model = machine.model;
  sim::PlantState& state = machine.state;
  double angle = 0.0, speed = 0.0, inertia = sim::driven_inertia(model.parameters), all = 0.0;
  for (int i = 0; i < model.group_count; ++i) {
    state.motor_angle[i] = encoder.shaft_position[i] / model.ratio;
    state.motor_speed[i] = encoder.shaft_speed[i] / model.ratio;
    speed += state.motor_speed[i] / model.group_count;
    all += model.group_inertia[i];
  }
  for (int i = 0; i < model.group_count; ++i) {
    double deflection = 0.0;
    if (!model.is_rigid) {
      const double pushed = torque.motor_torque[i] * model.parameters.drive.motors_per_group * model.ratio * inertia / (inertia + all);
      deflection = pushed == 0.0 ? 0.0 : std::copysign(model.gear[i].half_play, pushed) + pushed / model.gear[i].stiffness;
    }
    angle += (state.motor_angle[i] - deflection) / model.group_count;
  }
  std::fill(state.q.begin(), state.q.end(), 0.0);
  std::fill(state.v.begin(), state.v.end(), 0.0);
  state.q[0] = angle / model.house[0];
  state.v[0] = speed / model.house[0];
  if (model.has_load) {
    const Eigen::Vector2d place(model.tip[0] * state.q[0], 0.0), rate(model.tip[0] * state.v[0], 0.0);
    const Eigen::Vector2d q = model.load.modes.transpose() * (model.load.mass * place);
    const Eigen::Vector2d v = model.load.modes.transpose() * (model.load.mass * rate);
    state.load_q = {q(0), q(1)};
    state.load_v = {v(0), v(1)};
  }
  sim::refresh(model, state);
  machine.sensed = sim::read(model, state);
  sim::forget_past(machine);
}

}  // namespace

OpenLoopRun simulate_open_loop(const sim::MachineFile& file, const std::vector<common::EffectInstance>& effects,
                               const msgs::RunLog& record, double longest_step, std::int64_t configuration_hash) {
  const int groups = file.parameters.drive.group_count;
  if (record.encoder.size() < 2) throw std::invalid_argument("the record has fewer than two ENCODER");
  if (record.torque.empty()) throw std::invalid_argument("the record has no TORQUE: nothing drives the machine");
  for (const msgs::Encoder& encoder : record.encoder) {
    if (encoder.group_count != groups) {
      throw std::invalid_argument(fmt::format("the record is of {} motor groups, the machine has {}", encoder.group_count, groups));
    }
  }
  std::map<std::int64_t, const msgs::Torque*> answers;
  for (const msgs::Torque& torque : record.torque) {
    if (torque.group_count == groups) answers[torque.answered_sequence] = &torque;
  }

  OpenLoopRun result;
  const auto& first = record.encoder.front();
  const auto seconds_since = [&](std::int64_t time) { return static_cast<double>(time - first.simulated_time) / kNanosecondsPerSecond; };
  const std::int64_t periods = record.encoder.back().sequence - first.sequence;
  const double period = seconds_since(record.encoder.back().simulated_time) / static_cast<double>(std::max<std::int64_t>(1, periods));
  if (!(period > 0.0)) throw std::invalid_argument("the record's time does not rise");
  const double pieces = std::ceil(period / longest_step - 1e-9);
  result.step = period / pieces;

  sim::MachineSettings settings;
  settings.crane = file.parameters;
  settings.effects = effects;
  settings.step = result.step;
  sim::Machine machine = sim::make_machine(settings);
  const auto answer = answers.find(first.sequence);
  start_with(first, answer == answers.end() ? record.torque.front() : *answer->second, machine);

  // SENSORS that the record has, by its time; the load-side encoder's zero is the record's.
  std::map<std::int64_t, const msgs::Sensors*> sensors;
  for (const msgs::Sensors& message : record.sensors) sensors[message.simulated_time] = &message;
  const std::vector<double> measured_angle = values_or_nothing(record.sensors, &msgs::Sensors::slew_angle);
  const double angle_offset = measured_angle.empty() ? 0.0 : measured_angle.front() - sim::read(machine).slew_angle;

  result.run.configuration_hash = configuration_hash;
  result.run.operator_moves = record.operator_moves;
  for (msgs::Operator& move : result.run.operator_moves) move.configuration_hash = configuration_hash;

  sim::DriveCommand command;
  std::int64_t unanswered = 0, off_grid = 0, done = 0;
  const sim::DriveProtectionSettings& protection = file.drive_protection;
  for (const msgs::Encoder& recorded : record.encoder) {
    const double at = seconds_since(recorded.simulated_time) / result.step;
    const auto until = static_cast<std::int64_t>(std::llround(at));
    if (std::fabs(at - static_cast<double>(until)) > kOffGrid) ++off_grid;
    for (; done < until; ++done) sim::step(machine, command);

    const sim::PlantReadings readings = sim::read(machine);
    msgs::Encoder encoder = recorded;
    encoder.configuration_hash = configuration_hash;
    for (int i = 0; i < groups; ++i) {
      encoder.shaft_speed[i] = readings.shaft_speed[i];
      encoder.shaft_position[i] = readings.shaft_position[i];
      if (!std::isfinite(readings.shaft_speed[i]) || !std::isfinite(readings.shaft_position[i])) {
        throw std::runtime_error(fmt::format("the simulated motion is no longer finite at {:.6g} s", seconds_since(recorded.simulated_time)));
      }
    }
    result.run.encoder.push_back(std::move(encoder));
    if (const auto measured = sensors.find(recorded.simulated_time); measured != sensors.end()) {
      msgs::Sensors message = *measured->second;
      message.configuration_hash = configuration_hash;
      for (std::size_t k = 0; k < msgs::kSensorFields<msgs::Sensors>.size(); ++k) {
        const auto& field = msgs::kSensorFields<msgs::Sensors>[k];
        if (!std::isfinite(message.*field.value)) continue;
        message.*field.value = readings.*msgs::kSensorFields<sim::PlantReadings>[k].value;
        if (field.value == &msgs::Sensors::slew_angle) message.slew_angle += angle_offset;
      }
      result.run.sensors.push_back(message);
    }

    const auto answered = answers.find(recorded.sequence);
    if (answered == answers.end()) {
      ++unanswered;
      continue;
    }
    msgs::Torque torque = *answered->second;
    torque.configuration_hash = configuration_hash;
    command.sequence = torque.answered_sequence;
    command.enable = torque.enable;
    for (int i = 0; i < groups; ++i) {
      command.motor_torque[i] = std::clamp(torque.motor_torque[i], -protection.torque_limit, protection.torque_limit);
      command.brake_torque[i] = torque.brake ? protection.brake.torque : 0.0;
    }
    result.run.torque.push_back(std::move(torque));
  }
  if (unanswered > 0) {
    result.remarks.push_back(fmt::format("{} of {} ENCODER have no TORQUE of this machine in the record: the last torque is held there",
                                         unanswered, record.encoder.size()));
  }
  if (off_grid > 0) {
    result.remarks.push_back(fmt::format("{} ENCODER miss the grid of {:.6g} ms by more than {:.0f} % of a step", off_grid,
                                         1e3 * result.step, 100.0 * kOffGrid));
  }
  return result;
}

}  // namespace slewlab::tools
