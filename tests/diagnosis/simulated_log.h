// A log as the wire would hold it, from a machine and a controller in one process, with the noise of ordinary
// sensors.
#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "controller/process/computed_answer.h"
#include "diagnosis/loop/loop.h"
#include "diagnosis/loop/loop_log.h"
#include "msgs/run_log.h"

namespace slewlab::diagnosis {

struct Move {
  double time;           // [s]
  double speed_request;  // [-]
};

inline constexpr double kStep = 1e-3;  // [s] of the machine, and the controller's period unless another is given

// A crane behind ordinary sensors.
class NoisyPlant : public sim::CranePlant {
 public:
  NoisyPlant(sim::Machine machine, const sim::DriveProtectionSettings& protection, const sim::DriveRun& run, unsigned seed)
      : CranePlant(std::move(machine), protection, run), generator_(seed) {}

  void read_encoder(msgs::Encoder& message) override {
    constexpr double kCount = 2.0 * std::numbers::pi / 16384.0;  // [rad] encoder of 16384 counts per turn
    constexpr double kSpeedNoise = 2e-3;                         // [rad/s]
    CranePlant::read_encoder(message);
    for (double& speed : message.shaft_speed) speed += kSpeedNoise * normal_(generator_);
    for (double& position : message.shaft_position) position = std::round(position / kCount) * kCount;
  }
  void read_sensors(msgs::Sensors& message) override {
    constexpr double kAccelerometerNoise = 5e-3;  // [m/s^2]
    CranePlant::read_sensors(message);
    for (double* value : {&message.house_acceleration, &message.pivot_acceleration, &message.middle_acceleration, &message.tip_acceleration}) {
      *value += kAccelerometerNoise * normal_(generator_);
    }
  }

 private:
  std::mt19937 generator_;
  std::normal_distribution<double> normal_;
};

// From the state that the machine has; its step is kStep. Recorded once in a period [s] of the controller.
inline msgs::RunLog simulated_log(sim::Machine machine, controller::Compute compute, const std::vector<Move>& moves, double duration,
                                  unsigned seed, const sim::DriveProtectionSettings& protection = {}, double period = kStep) {
  const int groups = machine.model.group_count;
  LoopCourse course;
  course.plant_step = kStep;
  course.steps_per_period = std::lround(period / kStep);
  course.steps = std::lround(duration / kStep);
  for (const Move& move : moves) course.operator_moves.push_back({.time = std::llround(move.time * 1e9), .speed_request = move.speed_request});
  NoisyPlant plant(std::move(machine), protection, drive_run(course, groups), seed);
  ControllerAnswer controller(std::move(compute));
  msgs::RunLog log;
  LoopHooks hooks;
  hooks.operator_moved = [&](const msgs::Operator& move) { log.operator_moves.push_back(move); };
  hooks.answered = [&](const LoopMoment& moment) {
    log.encoder.push_back(moment.encoder);
    log.torque.push_back(controller.torque());
    if (moment.step == 0) return;
    msgs::Sensors sensors{};
    sensors.sequence = moment.step;
    sensors.simulated_time = moment.time;
    plant.read_sensors(sensors);
    log.sensors.push_back(sensors);
  };
  run_loop(course, plant, std::ref(controller), hooks);
  return log;
}

inline msgs::RunLog simulated_log(sim::Machine machine, controller::ControllerSettings settings, const std::vector<Move>& moves,
                                  double duration, unsigned seed, const sim::DriveProtectionSettings& protection = {}, double period = kStep) {
  settings.period = period;
  return simulated_log(std::move(machine), controller::computed_answer(settings), moves, duration, seed, protection, period);
}

inline msgs::RunLog simulated_log(sim::MachineSettings machine, const controller::ControllerSettings& controller,
                                  const std::vector<Move>& moves, double duration, unsigned seed, double period = kStep) {
  machine.step = kStep;
  return simulated_log(sim::make_machine(machine), controller, moves, duration, seed, machine.drive_protection, period);
}

// The same machine as slewlab's own run logs it, without any noise; sensors as often as the controller.
inline msgs::RunLog quiet_log(const sim::MachineSettings& machine, const controller::ControllerSettings& controller, const std::vector<Move>& moves, double duration, double period) {
  LoopSettings settings;
  settings.machine = machine;
  settings.machine.step = kStep;
  settings.controller = controller;
  settings.controller.period = period;
  settings.duration = duration;
  for (const Move& move : moves) settings.operator_moves.push_back({.time = std::llround(move.time * 1e9), .speed_request = move.speed_request});
  return logged_run(settings, {.sensors = std::llround(period * 1e9), .truth = 1'000'000'000, .status = 1'000'000'000});
}

// The log of a recorder that was switched on so many messages of each channel later.
inline void leave_out_beginning(msgs::RunLog& log, std::ptrdiff_t count) {
  const auto cut = [&](auto& messages) { messages.erase(messages.begin(), messages.begin() + count); };
  cut(log.encoder);
  cut(log.torque);
  cut(log.sensors);
}

}  // namespace slewlab::diagnosis
