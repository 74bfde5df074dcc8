// Plant and reference driven by one and the same source of torque, and their difference. For the accuracy tests
// and the benchmarks.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "controller/controller.h"
#include "controller/controller_file.h"
#include "sim/integrate/plant.h"
#include "sim/integrate/reference.h"
#include "sim/drive/scenario_file.h"

namespace slewlab::sim {

// What drives a machine: torque per motor of each group from time and shaft speeds, once per `period`.
struct Drive {
  double period = 0.0;    // [s]
  double duration = 0.0;  // [s]
  double sample = 2e-3;   // [s] between readings; what steps of 2, 1, 0.5 and 0.25 ms have in common
  std::function<GroupArray(double time, const GroupArray& shaft_speed)> torque;
};

struct Record {
  double sample = 0.0;                   // [s]
  std::vector<double> tip_acceleration;  // [m/s^2]
  std::vector<double> gear_torque;       // [Nm] of the first group
  std::int64_t crossings = 0;            // of all groups
};

inline std::int64_t whole(double number) { return static_cast<std::int64_t>(std::llround(number)); }

inline Record run_plant(const CraneParameters& crane, const Drive& drive, double step_length) {
  const PlantModel model = make_plant_model(crane, step_length);
  PlantWorkspace workspace = make_plant_workspace(model);
  PlantState state = make_plant_state(model);
  PlantInput input;
  Record result;
  result.sample = drive.sample;
  for (std::int64_t n = 0; n < whole(drive.duration / step_length); ++n) {
    if (n % whole(drive.period / step_length) == 0) {
      input.motor_torque = drive.torque(static_cast<double>(n) * step_length, read(model, state).shaft_speed);
    }
    step(model, workspace, input, state);
    if ((n + 1) % whole(drive.sample / step_length) != 0) continue;
    result.tip_acceleration.push_back(read(model, state).tip_acceleration);
    result.gear_torque.push_back(state.gear_torque[0]);
  }
  for (int i = 0; i < model.group_count; ++i) result.crossings += state.play_crossings[i];
  return result;
}

inline Record run_reference(const CraneParameters& crane, const Drive& drive, const ReferenceOptions& options) {
  const ReferencePointer reference = make_reference(crane, options);
  GroupArray torque{};
  Record result;
  result.sample = drive.sample;
  for (std::int64_t n = 0; n < whole(drive.duration / drive.sample); ++n) {
    if (n % whole(drive.period / drive.sample) == 0) {
      torque = drive.torque(static_cast<double>(n) * drive.sample, read(*reference).shaft_speed);
    }
    advance(*reference, torque, static_cast<double>(n + 1) * drive.sample);
    result.tip_acceleration.push_back(read(*reference).tip_acceleration);
    result.gear_torque.push_back(gear_torques(*reference)[0]);
  }
  for (const std::int64_t crossings : play_crossings(*reference)) result.crossings += crossings;
  return result;
}

// Root mean square of the difference as a share of the truth's, between two times [s].
inline double relative_error(const Record& truth, const std::vector<double>& signal,
                             const std::vector<double>& true_signal, double from, double to) {
  double difference = 0.0, size = 0.0;
  for (std::size_t k = 0; k < true_signal.size(); ++k) {
    const double time = static_cast<double>(k + 1) * truth.sample;
    if (time < from || time >= to) continue;
    difference += (signal.at(k) - true_signal[k]) * (signal.at(k) - true_signal[k]);
    size += true_signal[k] * true_signal[k];
  }
  return std::sqrt(difference / size);
}
inline double tip_error(const Record& record, const Record& truth, double from = 0.0, double to = 1e9) {
  return relative_error(truth, record.tip_acceleration, truth.tip_acceleration, from, to);
}
inline double gear_error(const Record& record, const Record& truth) {
  return relative_error(truth, record.gear_torque, truth.gear_torque, 0.0, 1e9);
}

struct Demo {
  CraneParameters crane;
  Scenario scenario;
  controller::ControllerSettings settings;
};

inline Demo load_demo(const std::string& file) {
  Demo demo;
  demo.scenario = load_scenario_file(file);
  demo.crane = demo.scenario.crane.parameters;
  demo.settings = controller::load_controller_file(demo.scenario.controller_file).settings;
  demo.settings.period = 1e-9 * static_cast<double>(demo.scenario.controller_period);
  return demo;
}

// A controller that starts anew with every run.
inline Drive drive_of(const Demo& demo) {
  Drive drive;
  drive.period = demo.settings.period;
  drive.duration = 1e-9 * static_cast<double>(demo.scenario.duration);
  const double samples = drive.period / drive.sample;  // a torque begins with a sample
  if (std::fabs(samples - std::round(samples)) > 1e-9) drive.sample = 1e-3;
  auto state = std::make_shared<controller::ControllerState>();
  drive.torque = [&demo, state](double time, const GroupArray& shaft_speed) {
    if (time == 0.0) *state = {};
    controller::ControllerInput input;
    input.simulated_time = whole(time * 1e9);
    input.group_count = demo.settings.group_count;
    input.shaft_speed = shaft_speed;
    for (const OperatorMove& move : demo.scenario.moves) {
      if (move.time > input.simulated_time) break;
      input.speed_request = move.speed_request;
      input.emergency_stop = move.emergency_stop;
      input.acknowledge = move.acknowledge;
    }
    controller::ControllerOutput output;
    controller::step(demo.settings, *state, input, output);
    GroupArray torque{};
    for (int i = 0; i < demo.settings.group_count; ++i) torque[i] = output.enable ? output.motor_torque[i] : 0.0;
    return torque;
  };
  return drive;
}

// Three slews to and fro in 12 s, the groups 40 Nm apart: every reversal crosses the play, some with bounces.
inline Drive to_and_fro() {
  return {.period = 0.01, .duration = 12.0, .torque = [](double time, const GroupArray&) {
            const double common = 150.0 * std::sin(1.5 * time);  // [Nm] per motor
            return GroupArray{common + 20.0, common - 20.0};
          }};
}

}  // namespace slewlab::sim
