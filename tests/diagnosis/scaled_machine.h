// The thesis's crane with its controller in another size, and a log of it: what must not change a diagnosis.
#pragma once

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "controller/controller.h"
#include "msgs/run_log.h"
#include "sim/integrate/machine.h"
#include "tests/diagnosis/bench.h"
#include "tests/sim/scaled_crane.h"

namespace slewlab::diagnosis {

struct Scaling {
  double mass = 1.0;       // of all masses and forces
  double root_time = 1.0;  // of all times; lengths by its square (Froude: gravity stays)
  double length() const { return root_time * root_time; }
  double torque() const { return mass * length(); }
  double speed() const { return 1.0 / root_time; }
};

inline sim::CraneParameters scaled(const sim::CraneParameters& crane, const Scaling& scaling) {
  return sim::with_lengths_times(sim::with_masses_times(crane, scaling.mass), scaling.length());
}

inline controller::ControllerSettings scaled(controller::ControllerSettings controller, const Scaling& scaling) {
  controller.rated_torque *= scaling.torque();
  controller.limits.torque *= scaling.torque();
  controller.limits.rate *= scaling.torque() / scaling.root_time;
  for (double* time : {&controller.period, &controller.speed_filter_time, &controller.speed_control.integral_time, &controller.ramp.acceleration_time,
                       &controller.ramp.deceleration_time, &controller.ramp.emergency_stop_time, &controller.plausibility.timeout}) {
    *time *= scaling.root_time;
  }
  for (double* speed : {&controller.ramp.top_speed, &controller.speed_control.droop, &controller.plausibility.speed_limit, &controller.plausibility.tolerance}) {
    *speed *= scaling.speed();
  }
  controller.plausibility.acceleration_limit *= scaling.speed() / scaling.root_time;
  controller.speed_control.proportional_gain *= scaling.torque() / scaling.speed();
  return controller;
}

// As the wire would hold it, encoders and accelerometers read every `period` [s]: counts of 14 bits, noise of ordinary sensors, the same
// numbers in every size. Times of the moves are those of the crane in its own size.
inline msgs::RunLog scaled_log(const sim::MachineSettings& truth, const Scaling& scaling, double period, const std::vector<Move>& moves, double duration) {
  constexpr double kCount = 2.0 * std::numbers::pi / 16384.0;  // [rad]
  constexpr double kSpeedNoise = 2e-3;                         // [rad/s] of the crane in its own size
  constexpr double kAccelerationNoise = 5e-3;                  // [m/s^2]
  std::mt19937 generator(1);
  std::normal_distribution<double> normal;
  sim::MachineSettings settings = truth;
  settings.crane = scaled(truth.crane, scaling);
  settings.step = period * scaling.root_time;
  controller::ControllerSettings controller = bench().controller;
  controller.period = period;
  controller = scaled(controller, scaling);
  sim::Machine machine = sim::make_machine(settings);
  const auto groups = static_cast<std::size_t>(machine.model.group_count);
  controller::ControllerState state;
  controller::ControllerInput input;
  controller::ControllerOutput output;
  input.group_count = machine.model.group_count;
  sim::DriveCommand command;
  msgs::RunLog log;
  std::size_t move = 0;
  const auto cycle = std::llround(settings.step * 1e9);  // [ns]
  for (int n = 0; n < std::lround(duration / period); ++n) {
    const std::int64_t now = n * cycle;
    while (move < moves.size() && moves[move].time <= n * period + 1e-9) {
      input.speed_request = moves[move++].speed_request;
      msgs::Operator message{};
      message.simulated_time = now;
      message.speed_request = input.speed_request;
      log.operator_moves.push_back(message);
    }
    const sim::MachineReadings readings = sim::read(machine);
    msgs::Encoder encoder{};
    encoder.sequence = n;
    encoder.simulated_time = now;
    encoder.group_count = machine.model.group_count;
    msgs::Torque torque{};
    torque.sequence = torque.answered_sequence = n;
    torque.simulated_time = now;
    torque.enable = true;
    torque.group_count = machine.model.group_count;
    for (std::size_t g = 0; g < groups; ++g) {
      encoder.shaft_speed.push_back(readings.shaft_speed[g] + scaling.speed() * kSpeedNoise * normal(generator));
      encoder.shaft_position.push_back(std::round(readings.shaft_position[g] / kCount) * kCount);
      input.shaft_speed[g] = encoder.shaft_speed[g];
    }
    msgs::Sensors sensors{};
    sensors.sequence = n;
    sensors.simulated_time = now;
    sensors.house_acceleration = readings.house_acceleration + kAccelerationNoise * normal(generator);
    sensors.pivot_acceleration = readings.pivot_acceleration + kAccelerationNoise * normal(generator);
    sensors.middle_acceleration = readings.middle_acceleration + kAccelerationNoise * normal(generator);
    sensors.tip_acceleration = readings.tip_acceleration + kAccelerationNoise * normal(generator);
    log.sensors.push_back(sensors);
    input.simulated_time = now;
    controller::step(controller, state, input, output);
    for (std::size_t g = 0; g < groups; ++g) {
      torque.motor_torque.push_back(output.motor_torque[g]);
      command.motor_torque[g] = output.motor_torque[g];
    }
    command.sequence = n;
    log.encoder.push_back(encoder);
    log.torque.push_back(torque);
    sim::step(machine, command);
  }
  return log;
}

}  // namespace slewlab::diagnosis
