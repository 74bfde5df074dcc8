#include "diagnosis/prediction.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "diagnosis/loop/loop.h"
#include "diagnosis/shadow.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kNanosecondsPerSecond = 1e9;

}  // namespace

SignalGap gap_between(const std::string& signal, const char* unit, std::span<const double> measured, std::span<const double> predicted) {
  const double count = static_cast<double>(measured.size());
  const double mean = std::accumulate(measured.begin(), measured.end(), 0.0) / count;
  double square = 0.0, difference = 0.0;
  for (std::size_t n = 0; n < measured.size(); ++n) {
    square += (measured[n] - mean) * (measured[n] - mean);
    difference += (measured[n] - predicted[n]) * (measured[n] - predicted[n]);
  }
  return {signal, unit, std::sqrt(square / count), std::sqrt(difference / count)};
}

std::vector<SignalGap> signal_gaps(const Record& measured, const Record& predicted, double from_time) {
  std::size_t from = 0;
  while (from + 1 < measured.size() && measured.time(from) < from_time) ++from;
  std::vector<SignalGap> gaps;
  const auto add = [&](const std::string& signal, const char* unit, const std::vector<double>& a, const std::vector<double>& b) {
    gaps.push_back(gap_between(signal, unit, std::span(a).subspan(from), std::span(b).subspan(from)));
  };
  std::vector<double> shifted;
  for (int g = 0; g < measured.group_count; ++g) {
    const auto i = static_cast<std::size_t>(g);
    add(fmt::format("torque of group {}", g + 1), "Nm", measured.motor_torque[i], predicted.motor_torque[i]);
    add(fmt::format("shaft speed of group {}", g + 1), "rad/s", measured.shaft_speed[i], predicted.shaft_speed[i]);
  }
  for (int a = 0; a < kAccelerometerCount; ++a) {
    const auto i = static_cast<std::size_t>(a);
    if (measured.acceleration[i].empty()) continue;
    // Less the mean difference, which may be the sensor's offset.
    shifted = predicted.acceleration[i];
    double offset = 0.0;
    for (std::size_t n = from; n < shifted.size(); ++n) offset += (measured.acceleration[i][n] - shifted[n]) / static_cast<double>(shifted.size() - from);
    for (double& value : shifted) value += offset;
    add(fmt::format("{} acceleration", accelerometer_name(a)), "m/s^2", measured.acceleration[i], shifted);
  }
  return gaps;
}

namespace {

std::vector<sim::OperatorMove> moves_of(const Record& record) {
  const std::int64_t start = std::llround(record.start_time * kNanosecondsPerSecond);
  std::vector<sim::OperatorMove> moves;
  for (const OperatorMove& move : record.operator_moves) {
    moves.push_back({move.simulated_time - start, move.speed_request, move.emergency_stop, move.acknowledge});
  }
  return moves;
}

// Steps of the machine per step of the grid: its own where a force or a friction acts between two readings, else the grid's; a whole number of
// them between two answers of the controller.
int steps_per_point(const sim::MachineSettings& machine, const Record& record) {
  const bool has_forces = std::any_of(machine.effects.begin(), machine.effects.end(), [](const common::EffectInstance& effect) { return acts_by_force(effect.name); });
  const int own = has_forces ? steps_of_the_settings(machine, record.step) : 1;
  const int answers = std::max(1, static_cast<int>(std::lround(record.step / record.encoder_period)));
  return (own + answers - 1) / answers * answers;
}

// The series of a record, on its grid, as machine and controller make them in closed loop.
Record simulated(const LoopSettings& settings, const Record& record, int steps) {
  Record series;
  series.name = record.name;
  series.step = record.step;
  series.start_time = record.start_time;
  series.group_count = record.group_count;
  MachineLoop loop(settings);
  loop.course.ends_with_answer = true;  // the last point of a record is one of its grid, too
  LoopHooks hooks;
  hooks.instant = [&](const LoopMoment& moment) {
    if (moment.step % steps != 0) return;
    const sim::MachineReadings readings = sim::read(loop.plant.machine());
    for (std::size_t g = 0; g < static_cast<std::size_t>(record.group_count); ++g) {
      series.motor_torque[g].push_back(loop.controller.torque().motor_torque[g]);
      series.shaft_speed[g].push_back(readings.shaft_speed[g]);
      series.shaft_position[g].push_back(readings.shaft_position[g]);
    }
    for (std::size_t a = 0; a < kAccelerometerCount; ++a) series.acceleration[a].push_back(readings.*kAccelerometers<sim::PlantReadings>[a].value);
    series.slew_angle.push_back(readings.slew_angle);
  };
  loop.run(hooks);
  return series;
}

}  // namespace

Prediction predict(const sim::MachineSettings& machine, const controller::ControllerSettings& controller, const Record& record,
                   double from_time) {
  LoopSettings settings;
  settings.machine = machine;
  const int steps = steps_per_point(machine, record);
  settings.machine.step = record.step / steps;
  settings.machine.started_at = record.effects_begin();
  settings.controller = controller;
  settings.controller.period = record.encoder_period;
  settings.operator_moves = moves_of(record);
  settings.duration = record.step * static_cast<double>(record.size() - 1);
  Prediction prediction;
  prediction.series = simulated(settings, record, steps);
  prediction.gaps = signal_gaps(record, prediction.series, from_time);
  double sum = 0.0;
  for (const SignalGap& gap : prediction.gaps) {
    const double share = gap.measured > 0.0 ? gap.gap / gap.measured : 0.0;
    sum += share * share;
  }
  prediction.relative_gap = std::sqrt(sum / static_cast<double>(prediction.gaps.size()));
  return prediction;
}

}  // namespace slewlab::diagnosis
