#include "diagnosis/loop/closed_loop.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "sim/model/drive_line.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kPeriodTolerance = 1e-9;  // [-] share of a step by which the periods may miss each other

std::int64_t steps_per_period(const ClosedLoopRun& run) {
  const double share = run.controller.period / run.plant_step;
  const double whole = std::round(share);
  if (!(whole >= 1.0) || std::fabs(share - whole) > kPeriodTolerance * whole) {
    throw std::invalid_argument("the controller's period must be a whole multiple of the plant's step");
  }
  return static_cast<std::int64_t>(whole);
}

}  // namespace

ClosedLoopSeries run_closed_loop(const ClosedLoopRun& run) {
  const std::int64_t period_steps = steps_per_period(run);
  if (run.controller.group_count != run.crane.drive.group_count) {
    throw std::invalid_argument("crane and controller differ in their number of motor groups");
  }
  const double ratio = sim::total_ratio(run.crane.drive);
  if (std::fabs(run.controller.total_ratio / ratio - 1.0) > 0.01) {
    throw std::invalid_argument("crane and controller differ by more than 1 % in the total ratio");
  }

  const sim::PlantModel model = sim::make_plant_model(run.crane, run.plant_step);
  sim::PlantWorkspace workspace = sim::make_plant_workspace(model);
  sim::PlantState state = sim::make_plant_state(model);
  controller::ControllerState controller_state;
  controller::ControllerOutput output;
  sim::PlantInput plant_input;
  const int groups = model.group_count;
  const auto step_count = static_cast<std::int64_t>(std::llround(run.duration / run.plant_step));
  const double sensor_radius = run.crane.house.sensor_radius;

  ClosedLoopSeries series;
  series.step = run.plant_step;
  series.group_count = groups;
  if (run.record_shear) series.shear.resize(static_cast<std::size_t>(run.crane.boom.element_count));
  std::vector<double> shear(static_cast<std::size_t>(run.crane.boom.element_count));

  std::size_t next_event = 0;
  OperatorEvent operator_now;
  for (std::int64_t n = 0; n < step_count; ++n) {
    if (n % period_steps == 0) {
      const double now = static_cast<double>(n) * run.plant_step;
      while (next_event < run.schedule.size() &&
             run.schedule[next_event].time <= now + kPeriodTolerance * run.plant_step) {
        operator_now = run.schedule[next_event++];
      }
      controller::ControllerInput input;
      input.simulated_time = std::llround(now * 1e9);
      input.group_count = groups;
      for (int i = 0; i < groups; ++i) input.shaft_speed[i] = state.motor_speed[i] * model.ratio;
      input.speed_request = operator_now.speed_request;
      input.emergency_stop = operator_now.emergency_stop;
      input.acknowledge = operator_now.acknowledge;
      controller::step(run.controller, controller_state, input, output);
      for (int i = 0; i < groups; ++i) plant_input.motor_torque[i] = output.enable ? output.motor_torque[i] : 0.0;
    }
    const auto crossings_before = state.play_crossings;
    sim::step(model, workspace, plant_input, state);

    const double time = static_cast<double>(state.step_count) * run.plant_step;
    const sim::PlantReadings readings = sim::read(model, state);
    series.time.push_back(time);
    series.ramped_speed.push_back(output.ramped_speed);
    series.slew_angle.push_back(state.house_angle);
    series.house_speed.push_back(state.house_speed);
    series.house_acceleration.push_back(readings.house_acceleration / sensor_radius);
    series.middle_acceleration.push_back(readings.middle_acceleration);
    series.tip_velocity.push_back(state.tip_velocity);
    series.tip_acceleration.push_back(readings.tip_acceleration);
    series.rope_angle.push_back(sim::rope_angle(model, state));
    series.rod_angle.push_back(sim::rod_angle(model, state));
    series.average_torque.push_back(output.average_torque);
    for (int i = 0; i < groups; ++i) {
      series.shaft_speed[i].push_back(readings.shaft_speed[i]);
      series.motor_torque[i].push_back(plant_input.motor_torque[i]);
      series.gear_torque[i].push_back(state.gear_torque[i]);
      series.deflection[i].push_back(sim::gear_deflection(state, i));
      for (std::int64_t c = crossings_before[i]; c < state.play_crossings[i]; ++c) {
        series.crossing_times[i].push_back(time);
      }
    }
    if (run.record_shear) {
      sim::shear_forces(model, state, shear.data());
      for (std::size_t e = 0; e < shear.size(); ++e) series.shear[e].push_back(shear[e]);
    }
  }
  series.mode_steps = step_count * model.mode_count;
  series.contact_changes = state.contact_changes;
  return series;
}

std::size_t index_at(const ClosedLoopSeries& series, double time) {
  const auto found = std::lower_bound(series.time.begin(), series.time.end(), time - 0.5 * series.step);
  return static_cast<std::size_t>(found - series.time.begin());
}

int crossings_between(const ClosedLoopSeries& series, int group, double from, double to) {
  const auto& times = series.crossing_times[static_cast<std::size_t>(group)];
  return static_cast<int>(
      std::count_if(times.begin(), times.end(), [&](double t) { return t >= from && t < to; }));
}

std::vector<double> sign_changes(const ClosedLoopSeries& series, int group, double from, double to) {
  const auto& torque = series.gear_torque[static_cast<std::size_t>(group)];
  std::vector<double> times;
  int last = 0;
  for (std::size_t i = index_at(series, from); i < torque.size() && series.time[i] < to; ++i) {
    const int sign = torque[i] > 0.0 ? 1 : torque[i] < 0.0 ? -1 : 0;
    if (sign == 0) continue;
    if (last != 0 && sign != last) times.push_back(series.time[i]);
    last = sign;
  }
  return times;
}

}  // namespace slewlab::diagnosis
