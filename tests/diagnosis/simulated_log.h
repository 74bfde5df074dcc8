// A log as the wire would hold it, from a machine and a controller in one process, with the noise of ordinary
// sensors.
#pragma once

#include <cmath>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "controller/controller.h"
#include "msgs/run_log.h"
#include "sim/integrate/machine.h"

namespace slewlab::diagnosis {

struct Move {
  double time;           // [s]
  double speed_request;  // [-]
};

inline constexpr double kStep = 1e-3;  // [s] of the machine, and the controller's period

// From the state that the machine has; its step is kStep.
inline msgs::RunLog simulated_log(sim::Machine machine, controller::ControllerSettings controller, const std::vector<Move>& moves,
                                  double duration, unsigned seed) {
  constexpr double kCount = 2.0 * std::numbers::pi / 16384.0;     // [rad] encoder of 16384 counts per turn
  constexpr double kSpeedNoise = 2e-3;                            // [rad/s]
  constexpr double kAccelerometerNoise = 5e-3;                    // [m/s^2]
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  controller.period = kStep;
  const int groups = machine.model.group_count;
  controller::ControllerState state;
  controller::ControllerInput input;
  controller::ControllerOutput output;
  input.group_count = groups;
  sim::DriveCommand command;
  msgs::RunLog log;
  std::size_t move = 0;
  const auto steps = static_cast<int>(std::lround(duration / kStep));
  for (int n = 0; n < steps; ++n) {
    const std::int64_t now = n * 1000000LL;
    while (move < moves.size() && moves[move].time <= n * kStep + 1e-9) {
      input.speed_request = moves[move].speed_request;
      msgs::Operator message{};
      message.sequence = static_cast<std::int64_t>(move);
      message.simulated_time = now;
      message.speed_request = input.speed_request;
      log.operator_moves.push_back(message);
      ++move;
    }
    const sim::MachineReadings readings = sim::read(machine);
    msgs::Encoder encoder{};
    encoder.sequence = n;
    encoder.simulated_time = now;
    encoder.group_count = groups;
    for (std::size_t g = 0; g < static_cast<std::size_t>(groups); ++g) {
      encoder.shaft_speed.push_back(readings.shaft_speed[g] + kSpeedNoise * normal(generator));
      encoder.shaft_position.push_back(std::round(readings.shaft_position[g] / kCount) * kCount);
    }
    if (n > 0) {
      msgs::Sensors sensors{};
      sensors.sequence = n;
      sensors.simulated_time = now;
      sensors.house_acceleration = readings.house_acceleration + kAccelerometerNoise * normal(generator);
      sensors.pivot_acceleration = readings.pivot_acceleration + kAccelerometerNoise * normal(generator);
      sensors.middle_acceleration = readings.middle_acceleration + kAccelerometerNoise * normal(generator);
      sensors.tip_acceleration = readings.tip_acceleration + kAccelerometerNoise * normal(generator);
      sensors.slew_angle = readings.slew_angle;
      log.sensors.push_back(sensors);
    }
    input.simulated_time = now;
    for (std::size_t g = 0; g < static_cast<std::size_t>(groups); ++g) input.shaft_speed[g] = encoder.shaft_speed[g];
    controller::step(controller, state, input, output);
    msgs::Torque torque{};
    torque.sequence = n;
    torque.simulated_time = now;
    torque.answered_sequence = n;
    torque.enable = true;
    torque.group_count = groups;
    for (std::size_t g = 0; g < static_cast<std::size_t>(groups); ++g) {
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

inline msgs::RunLog simulated_log(sim::MachineSettings machine, const controller::ControllerSettings& controller,
                                  const std::vector<Move>& moves, double duration, unsigned seed) {
  machine.step = kStep;
  return simulated_log(sim::make_machine(machine), controller, moves, duration, seed);
}

}  // namespace slewlab::diagnosis
