// Plant and reference driven in the loop by one and the same source of torque, and their difference. For the accuracy
// tests and the benchmarks.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "controller/controller_file.h"
#include "diagnosis/loop/loop.h"
#include "sim/drive/scenario_file.h"
#include "sim/integrate/reference.h"

namespace slewlab::sim {

// What drives a machine.
struct Drive {
  double period = 0.0;    // [s]
  double duration = 0.0;  // [s]
  double sample = 2e-3;   // [s] between readings; what steps of 2, 1, 0.5 and 0.25 ms have in common
  std::vector<OperatorMove> operator_moves;
  std::function<diagnosis::Answer()> answer;  // starts what answers anew
};

struct Record {
  double sample = 0.0;                   // [s]
  std::vector<double> tip_acceleration;  // [m/s^2]
  std::vector<double> gear_torque;       // [Nm] of the first group
  std::int64_t crossings = 0;            // of all groups
};

inline std::int64_t whole(double number) { return static_cast<std::int64_t>(std::llround(number)); }

inline diagnosis::LoopCourse course_of(const Drive& drive, double step) {
  diagnosis::LoopCourse course;
  course.plant_step = step;
  course.steps_per_period = whole(drive.period / step);
  course.steps = whole(drive.duration / step);
  course.operator_moves = drive.operator_moves;
  return course;
}

inline Record run_plant(const CraneParameters& crane, const Drive& drive, double step_length) {
  const diagnosis::LoopCourse course = course_of(drive, step_length);
  MachineSettings settings;
  settings.crane = crane;
  settings.step = step_length;
  CranePlant plant(settings, diagnosis::drive_run(course, crane.drive.group_count));
  const Machine& machine = plant.machine();
  Record result;
  result.sample = drive.sample;
  diagnosis::LoopHooks hooks;
  hooks.stepped = [&](const diagnosis::LoopMoment& moment) {
    if (moment.step % whole(drive.sample / step_length) != 0) return;
    result.tip_acceleration.push_back(read(machine).tip_acceleration);
    result.gear_torque.push_back(machine.state.gear_torque[0]);
  };
  diagnosis::run_loop(course, plant, drive.answer(), hooks);
  for (int i = 0; i < machine.model.group_count; ++i) result.crossings += machine.state.play_crossings[i];
  return result;
}

// The reference behind a drive that does what it is told.
class ReferencePlant : public DrivenPlant {
 public:
  ReferencePlant(const CraneParameters& crane, const ReferenceOptions& options, double step)
      : reference(make_reference(crane, options)), groups_(crane.drive.group_count), step_(step) {}

  void read_encoder(msgs::Encoder& message) override {
    const PlantReadings readings = read(*reference);
    message.group_count = groups_;
    message.shaft_speed.assign(readings.shaft_speed.begin(), readings.shaft_speed.begin() + groups_);
    message.shaft_position.assign(readings.shaft_position.begin(), readings.shaft_position.begin() + groups_);
  }
  void begin_cycle(std::int64_t) override {}
  void receive(msgs::DecodeStatus, const msgs::Torque& message) override {
    torque_ = {};
    if (message.enable) std::copy(message.motor_torque.begin(), message.motor_torque.end(), torque_.begin());
  }
  void step(const PlantConditions&) override { advance(*reference, torque_, static_cast<double>(++steps_) * step_); }
  void read_sensors(msgs::Sensors&) override {}
  void read_truth(msgs::Truth&) override {}
  void read_status(msgs::PlantStatus&) override {}

  ReferencePointer reference;

 private:
  int groups_;
  double step_;  // [s]
  std::int64_t steps_ = 0;
  GroupArray torque_{};
};

inline Record run_reference(const CraneParameters& crane, const Drive& drive, const ReferenceOptions& options) {
  ReferencePlant plant(crane, options, drive.sample);
  Record result;
  result.sample = drive.sample;
  diagnosis::LoopHooks hooks;
  hooks.stepped = [&](const diagnosis::LoopMoment&) {
    result.tip_acceleration.push_back(read(*plant.reference).tip_acceleration);
    result.gear_torque.push_back(gear_torques(*plant.reference)[0]);
  };
  diagnosis::run_loop(course_of(drive, drive.sample), plant, drive.answer(), hooks);
  for (const std::int64_t crossings : play_crossings(*plant.reference)) result.crossings += crossings;
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

// The controller of the scenario.
inline Drive drive_of(const Demo& demo) {
  Drive drive;
  drive.period = demo.settings.period;
  drive.duration = 1e-9 * static_cast<double>(demo.scenario.duration);
  const double samples = drive.period / drive.sample;  // a torque begins with a sample
  if (std::fabs(samples - std::round(samples)) > 1e-9) drive.sample = 1e-3;
  auto state = std::make_shared<controller::ControllerState>();
  drive.operator_moves = demo.scenario.moves;
  drive.answer = [settings = demo.settings] { return diagnosis::ControllerAnswer(settings); };
  return drive;
}

// Three slews to and fro in 12 s, the groups 40 Nm apart: every reversal crosses the play, some with bounces.
inline GroupArray to_and_fro_torque(double time) {
  const double common = 150.0 * std::sin(1.5 * time);  // [Nm] per motor
  return {common + 20.0, common - 20.0};
}

inline Drive to_and_fro() {
  const auto start = [] {
    return [message = msgs::Torque{}](const msgs::Encoder& encoder, const msgs::Operator&, DrivenPlant& plant) mutable {
      const GroupArray torque = to_and_fro_torque(1e-9 * static_cast<double>(encoder.simulated_time));
      message.answered_sequence = message.sequence = message.alive_counter = encoder.sequence;
      message.enable = true;
      message.group_count = encoder.group_count;
      message.motor_torque.assign(torque.begin(), torque.begin() + encoder.group_count);
      plant.receive(msgs::DecodeStatus::ok, message);
    };
  };
  return {.period = 0.01, .duration = 12.0, .operator_moves = {}, .answer = start};
}

}  // namespace slewlab::sim
