#include "diagnosis/loop/closed_loop.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "sim/model/drive_line.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kRatioTolerance = 0.01;  // [-] chosen: a controller's ratio is rounded, not another gear's

void require_a_match(const LoopSettings& settings) {
  const sim::DriveParameters& drive = settings.machine.crane.drive;
  if (settings.controller.group_count != drive.group_count) {
    throw std::invalid_argument("crane and controller differ in their number of motor groups");
  }
  if (std::fabs(settings.controller.total_ratio / sim::total_ratio(drive) - 1.0) > kRatioTolerance) {
    throw std::invalid_argument("crane and controller differ by more than 1 % in the total ratio");
  }
}

class Sampler {
 public:
  Sampler(const LoopSettings& settings, const MachineLoop& loop, bool record_shear)
      : loop_(loop), sensor_radius_(settings.machine.crane.house.sensor_radius), crossings_(state().play_crossings) {
    series.step = settings.machine.step;
    series.group_count = model().group_count;
    if (!record_shear) return;
    shear_.resize(static_cast<std::size_t>(model().parameters.boom.element_count));
    series.shear.resize(shear_.size());
  }

  void sample() {
    const double time = static_cast<double>(state().step_count) * series.step;
    const sim::MachineReadings readings = sim::read(loop_.plant.machine());
    series.time.push_back(time);
    series.ramped_speed.push_back(loop_.controller.state().ramped_speed);
    series.average_torque.push_back(loop_.controller.state().average_torque);
    series.slew_angle.push_back(state().house_angle);
    series.house_speed.push_back(state().house_speed);
    series.house_acceleration.push_back(readings.house_acceleration / sensor_radius_);
    series.middle_acceleration.push_back(readings.middle_acceleration);
    series.tip_velocity.push_back(state().tip_velocity);
    series.tip_acceleration.push_back(readings.tip_acceleration);
    series.rope_angle.push_back(sim::rope_angle(model(), state()));
    series.rod_angle.push_back(sim::rod_angle(model(), state()));
    for (int i = 0; i < series.group_count; ++i) sample_group(i, time, readings);
    if (series.shear.empty()) return;
    sim::shear_forces(model(), state(), shear_.data());
    for (std::size_t e = 0; e < shear_.size(); ++e) series.shear[e].push_back(shear_[e]);
  }

  ClosedLoopSeries series;

 private:
  void sample_group(int i, double time, const sim::MachineReadings& readings) {
    series.shaft_speed[i].push_back(readings.shaft_speed[i]);
    series.motor_torque[i].push_back(loop_.plant.machine().applied_torque[i]);
    series.gear_torque[i].push_back(state().gear_torque[i]);
    series.deflection[i].push_back(sim::gear_deflection(state(), i));
    for (; crossings_[i] < state().play_crossings[i]; ++crossings_[i]) series.crossing_times[i].push_back(time);
  }

  const sim::PlantModel& model() const { return loop_.plant.machine().model; }
  const sim::PlantState& state() const { return loop_.plant.machine().state; }

  const MachineLoop& loop_;
  double sensor_radius_;  // [m]
  decltype(sim::PlantState::play_crossings) crossings_;  // seen so far
  std::vector<double> shear_;
};

}  // namespace

ClosedLoopSeries run_closed_loop(const LoopSettings& settings, bool record_shear) {
  require_a_match(settings);
  MachineLoop loop(settings);
  Sampler sampler(settings, loop, record_shear);
  LoopHooks hooks;
  hooks.stepped = [&](const LoopMoment&) { sampler.sample(); };
  const std::int64_t steps = loop.run(hooks);
  sampler.series.mode_steps = steps * loop.plant.machine().model.mode_count;
  sampler.series.contact_changes = loop.plant.machine().state.contact_changes;
  return std::move(sampler.series);
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
