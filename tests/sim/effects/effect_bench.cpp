#include "tests/sim/effects/effect_bench.h"

#include "sim/effects/catalogue.h"
#include "sim/integrate/machine.h"
#include "sim/machine/effect_scales.h"
#include "sim/model/boom.h"
#include "sim/model/drive_line.h"
#include "tests/sim/thesis_crane.h"

namespace slewlab::sim {

CraneParameters flexible_crane() { return thesis_crane(); }

CraneParameters rigid_crane() {
  CraneParameters crane = thesis_crane(0);
  crane.load = {};
  return crane;
}

CraneParameters rigid_crane_without_play() {
  CraneParameters crane = rigid_crane();
  crane.drive.gear_damping_ratio = 0.5;
  crane.drive.gearbox_play = crane.drive.pinion_play = 0.0;
  return crane;
}

CraneParameters rigid_crane_with_load(double rod_length) {
  CraneParameters crane = thesis_crane(0);
  crane.load.rod_length = rod_length;
  return crane;
}

CraneParameters pendulum(double mass, double rope_length) {
  CraneParameters crane = thesis_crane(0);
  crane.house.inertia = 1e18;
  crane.load = {.mass = mass, .rope_length = rope_length, .rod_length = 0.0, .damping_ratio = 0.0};
  return crane;
}

CraneParameters fixed_house() {
  CraneParameters crane = rigid_crane();
  crane.house.inertia = 1e18;
  crane.drive.gear_damping_ratio = 0.5;
  return crane;
}

double whole_inertia(const CraneParameters& crane) {
  return driven_inertia(crane) + crane.drive.group_count * group_inertia(crane.drive);
}
double house_and_boom_inertia(const CraneParameters& crane) { return driven_inertia(crane); }
double torque_factor(const CraneParameters& crane) {
  return crane.drive.motors_per_group * total_ratio(crane.drive);
}
double group_gear_stiffness(const CraneParameters& crane) { return group_stiffness(crane.drive); }
double group_half_play(const CraneParameters& crane) { return half_play(crane.drive); }

double energy_of_motion(const CraneParameters& crane, const BenchSample& sample) {
  const double house = house_and_boom_inertia(crane), motors = 0.5 * (whole_inertia(crane) - house);
  double sum = 0.5 * house * sample.house_speed * sample.house_speed;
  for (const int group : {0, 1}) sum += 0.5 * motors * sample.motor_speed[group] * sample.motor_speed[group];
  return sum;
}
double motion_lost(const CraneParameters& crane, const BenchSample& from, const BenchSample& to) {
  return energy_of_motion(crane, from) - energy_of_motion(crane, to);
}

DriveCommand no_drive(double) { return {}; }

Drive constant_drive(double first, double second) {
  return [=](double) {
    DriveCommand command;
    command.motor_torque = {first, second};
    return command;
  };
}

std::vector<BenchSample> run(const MachineSettings& settings, double duration, const Drive& drive,
                             const BenchStart& start) {
  // Machines of the bench are the thesis's crane with something held fast: its sizes count.
  MachineSettings in_its_units = settings;
  if (!in_its_units.scales) in_its_units.scales = effect_scales(thesis_crane());
  Machine machine = make_machine(in_its_units);
  const PlantModel& model = machine.model;
  PlantState& state = machine.state;
  if (start.slew_speed != 0.0) {
    // The rigid rotation is the first mode.
    state.v[0] = start.slew_speed / model.house[0];
    state.motor_speed.fill(start.slew_speed);
  }
  for (int i = 0; i < model.group_count; ++i) {
    const double torque = start.gear_torque[i];
    if (torque == 0.0) continue;
    state.motor_angle[i] =
        torque / model.gear[i].stiffness + (torque > 0.0 ? 1.0 : -1.0) * model.gear[i].half_play;
  }
  if (model.has_load) {
    const Eigen::Vector2d place(start.rope_angle * model.parameters.load.rope_length, start.rope_angle);
    const Eigen::Vector2d speed(start.slew_speed * sheave_radius(model.parameters.boom), 0.0);
    const Eigen::Vector2d q = model.load.modes.transpose() * (model.load.mass * place);
    const Eigen::Vector2d v = model.load.modes.transpose() * (model.load.mass * speed);
    for (int j = 0; j < 2; ++j) {
      state.load_q[j] += q(j);
      state.load_v[j] += v(j);
    }
  }
  refresh(model, state);
  if (start.outwards) begin_effects(machine, *start.outwards, 0.0);

  std::vector<BenchSample> samples;
  const auto steps = std::lround(duration / settings.step);
  samples.reserve(static_cast<std::size_t>(steps));
  for (long k = 0; k < steps; ++k) {
    step(machine, drive(static_cast<double>(k) * settings.step));
    BenchSample sample{.time = time_of(machine),
                       .readings = read(machine),
                       .applied_torque = machine.applied_torque,
                       .motor_angle = state.motor_angle,
                       .motor_speed = state.motor_speed,
                       .gear_torque = state.gear_torque,
                       .house_angle = state.house_angle,
                       .house_speed = state.house_speed,
                       .tip_displacement = state.tip_displacement,
                       .rope_angle = rope_angle(model, state),
                       .rod_angle = rod_angle(model, state)};
    for (int i = 0; i < model.group_count; ++i) sample.deflection[i] = gear_deflection(state, i);
    if (model.has_load) {
      sample.load_displacement =
          model.load.modes(0, 0) * state.load_q[0] + model.load.modes(0, 1) * state.load_q[1];
      sample.load_velocity =
          model.load.modes(0, 0) * state.load_v[0] + model.load.modes(0, 1) * state.load_v[1];
    }
    samples.push_back(sample);
  }
  return samples;
}

std::vector<BenchSample> run(const CraneParameters& crane, const std::string& effect,
                             const std::vector<double>& values, double duration, const Drive& drive,
                             const BenchStart& start) {
  return run({.crane = crane, .effects = {{effect, values}}}, duration, drive, start);
}

const common::EffectAbout& thesis_effect(std::string_view name) {
  static const common::EffectCatalogue catalogue = effects_for(thesis_crane());
  return catalogue.at(name);
}

std::unique_ptr<RunningEffect> started(const std::string& effect, const std::vector<double>& values, const PlantModel& model,
                                       std::uint64_t seed) {
  const EffectDescription* description = find_effect(effect);
  return description->start({{description->about, values}, model, effect_scales(thesis_crane()), seed});
}

void change_by(const std::string& effect, const std::vector<double>& values, MachineParameters& parameters) {
  const EffectDescription* description = find_effect(effect);
  description->change({description->about, values}, parameters);
}

double period_of(const std::vector<BenchSample>& samples,
                 const std::function<double(const BenchSample&)>& value) {
  double first = 0.0, last = 0.0;
  int count = 0;
  for (std::size_t k = 1; k < samples.size(); ++k) {
    const double a = value(samples[k - 1]), b = value(samples[k]);
    if (!(a < 0.0 && b >= 0.0)) continue;
    last = samples[k - 1].time + (samples[k].time - samples[k - 1].time) * a / (a - b);
    if (count++ == 0) first = last;
  }
  return count > 1 ? (last - first) / (count - 1) : 0.0;
}

}  // namespace slewlab::sim
