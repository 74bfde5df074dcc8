#include "diagnosis/balance/described_axis.h"

#include <algorithm>
#include <cmath>

#include "sim/drive/scenario_run.h"
#include "sim/integrate/machine.h"
#include "sim/machine/scales.h"
#include "sim/model/crane.h"
#include "sim/model/drive_line.h"

namespace slewlab::diagnosis {
namespace {

constexpr int kFiner = 4;  // plant steps per sample

double held_to_next(const std::vector<double>& values, std::size_t n) { return 0.5 * (values[n] + values[std::min(n + 1, values.size() - 1)]); }

void add_own_effects(const sim::MachineFile& axis, const std::vector<double>& position, double step, std::vector<double>& load) {
  sim::MachineSettings settings = sim::machine_settings(axis);
  if (settings.effects.empty()) return;
  settings.step = step;
  sim::Machine machine = sim::make_machine(settings);
  const std::vector<double> speeds = rough_speed(position, step);
  for (std::size_t n = 0; n < position.size(); ++n) {
    const double speed = held_to_next(speeds, n);
    sim::EffectMoment moment;
    moment.time = step * (static_cast<double>(n) + 0.5);
    moment.step = step;
    moment.house_angle = held_to_next(position, n);
    moment.house_speed = speed;
    moment.motor_angle.fill(moment.house_angle);
    moment.motor_speed.fill(speed);
    sim::PortForces forces{};
    sim::FrictionLevels levels{};
    for (const std::size_t e : machine.force) machine.effects[e]->force(moment, forces);
    for (const std::size_t e : machine.friction) machine.effects[e]->friction(moment, levels);
    double friction = speed > 0.0 ? -levels.house_positive : speed < 0.0 ? levels.house_negative : 0.0;
    for (int group = 0; group < machine.model.group_count; ++group) friction -= std::copysign(levels.motor[group], speed);
    load[n] += forces.house_torque + friction;
  }
}

// All of it moves as one; `push`: what the motor gives, on the axis.
void begin(double position, double speed, double push, GearBeginning beginning, sim::Machine& machine) {
  const sim::PlantModel& model = machine.model;
  sim::PlantState& state = machine.state;
  double deflection = 0.0;
  if (!model.is_rigid && beginning == GearBeginning::carrying) {
    const double driven = sim::driven_inertia(model.parameters), load = sim::axis_force_at(model.parameters.axis_force, position);
    const double carried = driven * (push + load) / (driven + model.group_inertia[0]) - load;
    deflection = carried == 0.0 ? 0.0 : std::copysign(model.gear[0].half_play, carried) + carried / model.gear[0].stiffness;
  }
  state.motor_angle[0] = position;
  state.motor_speed[0] = speed;
  std::fill(state.q.begin(), state.q.end(), 0.0);
  std::fill(state.v.begin(), state.v.end(), 0.0);
  state.q[0] = (position - deflection) / model.house[0];
  state.v[0] = speed / model.house[0];
  sim::refresh(model, state);
  machine.sensed = sim::read(model, state);
  sim::forget_past(machine);
}

}  // namespace

std::vector<double> rough_speed(const std::vector<double>& position, double step) {
  std::vector<double> speed(position.size(), 0.0);
  constexpr std::size_t kReach = 2;
  for (std::size_t n = 0; n < position.size(); ++n) {
    const std::size_t from = n > kReach ? n - kReach : 0, to = std::min(position.size() - 1, n + kReach);
    if (to > from) speed[n] = (position[to] - position[from]) / (step * static_cast<double>(to - from));
  }
  return speed;
}

std::vector<double> described_load(const sim::MachineFile& axis, const std::vector<double>& position, double step) {
  std::vector<double> load;
  for (std::size_t n = 0; n < position.size(); ++n) load.push_back(sim::axis_force_at(axis.parameters.axis_force, held_to_next(position, n)));
  add_own_effects(axis, position, step, load);
  return load;
}

AxisRecord described_record(const sim::MachineFile& axis, const AxisRecord& record, GearBeginning beginning, const std::vector<double>& led_by_speed) {
  sim::MachineSettings settings = sim::machine_settings(axis);
  settings.step = record.step / kFiner;
  sim::Machine machine = sim::make_machine(settings);
  const double ratio = sim::total_ratio(axis.parameters.drive), per_motor = ratio * axis.parameters.drive.motors_per_group;
  const double inertia = sim::rigid_inertia(axis.parameters), rate = 1.0 / sim::characteristic_time(axis.parameters);
  AxisRecord described{record.name, record.step, {}, record.effort, record.start_time, {}};
  for (std::size_t n = 0; n < record.load.size(); ++n) described.effort[n] -= record.load[n];
  begin(record.position.front(), rough_speed(record.position, record.step).front(), described.effort.front(), beginning, machine);
  sim::DriveCommand command;
  command.enable = true;
  for (std::size_t n = 0; n < described.effort.size(); ++n) {
    const sim::MachineReadings reading = sim::read(machine);
    described.position.push_back(reading.shaft_position[0] / ratio);
    if (!led_by_speed.empty()) {  // (1)
      const double behind = record.position[n] - described.position.back(), slower = led_by_speed[n] - reading.shaft_speed[0] / ratio;
      described.effort[n] += inertia * rate * (2.0 * slower + rate * behind);
    }
    command.sequence = static_cast<std::int64_t>(n);
    command.motor_torque[0] = described.effort[n] / per_motor;
    for (int i = 0; i < kFiner; ++i) sim::step(machine, command);
  }
  described.load = described_load(axis, described.position, record.step);
  for (std::size_t n = 0; n < described.load.size(); ++n) described.effort[n] += described.load[n];
  return described;
}

}  // namespace slewlab::diagnosis
