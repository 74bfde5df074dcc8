#include "sim/integrate/machine.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "sim/effects/accelerometers.h"
#include "sim/effects/axis_bounds.h"
#include "sim/effects/catalogue.h"
#include "sim/effects/random_number.h"
#include "sim/machine/effect_scales.h"
#include "sim/model/drive_line.h"

namespace slewlab::sim {

namespace {

constexpr double kNanosecond = 1e-9;  // [s]

// The crane at the end of a step, in the quantities that effects see.
void observe(const PlantModel& model, const PlantState& state, const Accelerations& acceleration, double rope_length, EffectMoment& moment) {
  for (int i = 0; i < model.group_count; ++i) {
    moment.motor_angle[i] = state.motor_angle[i];
    moment.motor_speed[i] = state.motor_speed[i];
    moment.gear_torque[i] = state.gear_torque[i];
  }
  moment.house_angle = state.house_angle;
  moment.house_speed = state.house_speed;
  moment.tip_displacement = state.tip_displacement;
  moment.tip_velocity = state.tip_velocity;
  moment.house_acceleration = acceleration.house;
  moment.boom_acceleration = acceleration.boom;
  moment.rope_force = state.rope_force;
  if (!model.has_load) return;
  moment.load_displacement =
      model.load.modes(0, 0) * state.load_q[0] + model.load.modes(0, 1) * state.load_q[1];
  moment.load_velocity = model.load.modes(0, 0) * state.load_v[0] + model.load.modes(0, 1) * state.load_v[1];
  moment.rope_angle = (moment.load_displacement - moment.tip_displacement) / rope_length;
  moment.rod_angle = rod_angle(model, state);
  moment.rod_rate = model.load.modes(1, 0) * state.load_v[0] + model.load.modes(1, 1) * state.load_v[1];
}

// Two steps' ends give the middle of the next step; without a step before, `before` is `now`. Fills what stands there already: copying what
// was written number by number a moment ago would wait for the writes.
void find_middle(const PlantState& state, int group_count, const EffectMoment& now, const EffectMoment& before, double time, double h, EffectMoment& m) {
  m.time = time + 0.5 * h;
  m.step = h;
  const auto ahead = [](double present, double past) { return 1.5 * present - 0.5 * past; };
  for (int i = 0; i < group_count; ++i) {
    m.motor_speed[i] = ahead(now.motor_speed[i], before.motor_speed[i]);
    m.motor_angle[i] = now.motor_angle[i] + 0.25 * h * (now.motor_speed[i] + m.motor_speed[i]);
    m.gear_torque[i] = state.contact[i] == 0 ? 0.0 : ahead(now.gear_torque[i], before.gear_torque[i]);
    // Teeth push and never pull, in the estimate too.
    if (state.contact[i] * m.gear_torque[i] < 0.0) m.gear_torque[i] = 0.0;
  }
  m.house_speed = ahead(now.house_speed, before.house_speed);
  m.house_angle = now.house_angle + 0.25 * h * (now.house_speed + m.house_speed);
  m.house_acceleration = ahead(now.house_acceleration, before.house_acceleration);
  m.tip_velocity = ahead(now.tip_velocity, before.tip_velocity);
  m.tip_displacement = now.tip_displacement + 0.25 * h * (now.tip_velocity + m.tip_velocity);
  m.boom_acceleration = ahead(now.boom_acceleration, before.boom_acceleration);
  m.load_velocity = ahead(now.load_velocity, before.load_velocity);
  m.load_displacement = now.load_displacement + 0.25 * h * (now.load_velocity + m.load_velocity);
  m.rope_angle = ahead(now.rope_angle, before.rope_angle);
  m.rod_rate = ahead(now.rod_rate, before.rod_rate);
  m.rod_angle = now.rod_angle + 0.25 * h * (now.rod_rate + m.rod_rate);
  m.rope_force = ahead(now.rope_force, before.rope_force);
}

const EffectDescription& described(const std::string& name) {
  const EffectDescription* description = find_effect(name);
  if (description == nullptr) throw std::invalid_argument("no effect is called " + name);
  return *description;
}

}  // namespace

MachineParameters machine_parameters(const MachineSettings& settings) {
  const CraneParameters& crane = settings.crane;
  MachineParameters parameters;
  parameters.crane = crane;
  parameters.group_inertia.fill(group_inertia(crane.drive));
  parameters.gear.fill(gear_contact(crane));
  if (settings.effects.empty()) return parameters;
  const common::EffectScales scales = settings.scales ? *settings.scales : effect_scales(crane, settings.drive_protection);
  const common::MachineParts parts = parts_of(crane);
  for (const common::EffectInstance& instance : settings.effects) {
    const EffectDescription& description = described(instance.name);
    const std::string missing = common::missing_parts(description.about.needs, parts);
    if (!missing.empty()) {
      throw std::invalid_argument("effect " + instance.name + " needs " + missing + ", which this machine has not");
    }
    common::EffectAbout about = common::in_units_of(description.about, scales);
    if (!parts.boom && parts.groups == 1) widen_for_a_plain_axis(description.about, about);
    common::check_instance(about, instance);
    if (description.change != nullptr) description.change({description.about, instance.values}, parameters);
  }
  return parameters;
}

Machine make_machine(const MachineSettings& settings) {
  for (std::size_t i = 0; i < settings.effects.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (settings.effects[i].name == settings.effects[j].name) {
        throw std::invalid_argument("effect " + settings.effects[i].name + " is given twice");
      }
    }
  }
  const MachineParameters parameters = machine_parameters(settings);
  Machine machine;
  machine.model =
      make_plant_model(parameters.crane, settings.step, parameters.group_inertia, parameters.gear);
  machine.workspace = make_plant_workspace(machine.model);
  common::EffectScales scales;
  if (!settings.effects.empty()) scales = settings.scales ? *settings.scales : effect_scales(settings.crane, settings.drive_protection);
  machine.state = make_plant_state(machine.model);
  for (const common::EffectInstance& instance : settings.effects) {
    const EffectDescription& description = described(instance.name);
    if (description.start == nullptr) continue;
    const std::size_t index = machine.effects.size();
    // By the effect's name, so that one effect draws the same numbers whatever else is switched on.
    std::uint64_t seed = settings.seed;
    for (const char letter : instance.name) seed = mixed(seed, static_cast<std::uint64_t>(letter));
    machine.effects.emplace_back(description.start({{description.about, instance.values}, machine.model, scales, seed}));
    machine.is_on.push_back(1);
    const bool is_switchable = std::find(description.ports.begin(), description.ports.end(), EffectPort::parameters) == description.ports.end();
    machine.switchable.push_back(is_switchable ? instance.name : "");
    for (const EffectPort port : description.ports) {
      switch (port) {
        case EffectPort::parameters:
          break;
        case EffectPort::message:
          machine.message.push_back(index);
          break;
        case EffectPort::actuator:
          machine.actuator.push_back(index);
          break;
        case EffectPort::force:
          machine.force.push_back(index);
          break;
        case EffectPort::friction:
          machine.friction.push_back(index);
          break;
        case EffectPort::sensor:
          machine.sensor.push_back(index);
          break;
      }
    }
  }
  machine.started_at = settings.started_at;
  machine.motion = crane_motion(parameters.crane, settings.motion_requests);
  machine.steps_per_boom_angle = settings.steps_per_boom_angle;
  if (!machine.motion.luffing.is_still()) {
    prepare_luffing(machine.motion, machine.model);
    machine.workspace = make_plant_workspace(machine.model);
  }
  machine.needs_moment = machine.motion.moves || !machine.actuator.empty() || !machine.force.empty() || !machine.friction.empty();
  machine.hooks_per_step =
      static_cast<std::int64_t>(machine.message.size() + machine.actuator.size() + machine.force.size() +
                                machine.friction.size() + machine.sensor.size());
  for (const EffectSwitch& change : settings.effect_switches) {
    const auto found = std::find(machine.switchable.begin(), machine.switchable.end(), change.effect);
    if (change.effect.empty() || found == machine.switchable.end()) {
      throw std::invalid_argument("effect " + change.effect + " cannot be switched: the machine has none of that name that acts while it runs");
    }
    const double step = static_cast<double>(change.time) * kNanosecond / settings.step;
    machine.switches.push_back({std::llround(step), static_cast<std::size_t>(found - machine.switchable.begin()), change.on});
  }
  rest_under_steady_forces(machine);
  machine.sensed = read(machine.model, machine.state);
  return machine;
}

namespace {

// For the stretch that begins now, the boom angle of its middle.
[[gnu::noinline]] void follow_boom_angle(Machine& machine) {
  constexpr double kSmallest = 1e-12;  // [rad] below which an angle is only rounded otherwise
  const double middle = time_of(machine) + 0.5 * machine.steps_per_boom_angle * machine.model.step;
  const double angle = boom_angle(machine.motion, middle);
  if (std::fabs(angle - machine.motion.basis.angle) <= kSmallest) return;
  luff(machine.motion, angle, machine.model, machine.state);
  machine.has_acceleration = false;  // that of the last step's end is one of other masses
}

bool is_sensed(const Machine& machine) { return !machine.sensor.empty() || machine.motion.moves; }

// What the sensors say at the end of a step, whose acceleration is known.
void sense(Machine& machine) {
  const SensorMoment moment{.time = time_of(machine),
                            .house_angle = machine.state.house_angle,
                            .house_speed = machine.state.house_speed,
                            .truth = read(machine.model, machine.state, machine.acceleration)};
  machine.sensed = moment.truth;
  if (machine.motion.moves) {
    add_to_accelerometers(machine.sensed, [&](std::string_view place) {
      return motion_acceleration(machine.motion, moment.time, moment.house_angle, moment.house_speed, place);
    });
  }
  for (const std::size_t i : machine.sensor) if (machine.is_on[i]) machine.effects[i]->sensor(moment, machine.sensed);
}

}  // namespace

void begin_step(Machine& machine, const DriveCommand& command, PlantInput& input) {
  const PlantModel& model = machine.model;
  const double time = time_of(machine);
  while (machine.next_switch < machine.switches.size() && machine.switches[machine.next_switch].step <= machine.state.step_count) {
    const Machine::Switch& due = machine.switches[machine.next_switch++];
    machine.is_on[due.effect] = due.on;
  }

  if (!machine.motion.luffing.is_still() && machine.state.step_count % machine.steps_per_boom_angle == 0) follow_boom_angle(machine);

  const DriveCommand* arrived = &command;
  if (!machine.message.empty()) {
    machine.arrived = command;
    for (const std::size_t i : machine.message) if (machine.is_on[i]) machine.effects[i]->message(time, machine.arrived);
    arrived = &machine.arrived;
  }

  input.ports = machine.outside;
  if (arrived->enable) {
    input.motor_torque = arrived->motor_torque;
  } else {
    input.motor_torque.fill(0.0);
  }
  input.friction = {};
  for (int i = 0; i < model.group_count; ++i) {
    input.friction.motor[i] =
        arrived->brake_torque[i] * model.parameters.drive.motors_per_group * model.ratio;
  }

  if (machine.needs_moment) {
    if (!machine.has_acceleration) machine.acceleration = accelerations(model, machine.state);
    machine.newest = 1 - machine.newest;
    const EffectMoment& now = machine.ends[machine.newest];
    observe(model, machine.state, machine.acceleration,
            machine.motion.moves ? rope_length(machine.motion, time) : model.parameters.load.rope_length, machine.ends[machine.newest]);
    const EffectMoment& before = machine.has_past ? machine.ends[1 - machine.newest] : now;
    machine.has_past = true;
    EffectMoment& moment = machine.middle;
    find_middle(machine.state, model.group_count, now, before, time, model.step, moment);
    for (const std::size_t i : machine.actuator) if (machine.is_on[i]) machine.effects[i]->actuator(moment, input.motor_torque);
    for (const std::size_t i : machine.force) if (machine.is_on[i]) machine.effects[i]->force(moment, input.ports);
    for (const std::size_t i : machine.friction) if (machine.is_on[i]) machine.effects[i]->friction(moment, input.friction);
    if (machine.motion.moves) {
      add_motion_forces(machine.motion,
                        {.time = moment.time, .house_angle = moment.house_angle, .house_speed = moment.house_speed,
                         .rope_difference = moment.load_displacement - moment.tip_displacement, .rod_angle = moment.rod_angle},
                        input.ports);
      input.ports.luffing = luffing_force(machine.motion, moment.time, moment.house_speed);
    }
  }
  machine.applied_torque = input.motor_torque;
}

void end_step(Machine& machine) {
  if (is_sensed(machine)) sense(machine);
  machine.effect_evaluations += machine.hooks_per_step;
}

void step(Machine& machine, const DriveCommand& command) {
  begin_step(machine, command, machine.input);
  step(machine.model, machine.workspace, machine.input, machine.state);
  machine.has_acceleration = machine.needs_moment || is_sensed(machine);
  if (machine.has_acceleration) machine.acceleration = accelerations(machine.model, machine.state);
  end_step(machine);
}

MachineReadings read(const Machine& machine) {
  MachineReadings readings = is_sensed(machine)         ? machine.sensed
                             : machine.has_acceleration ? read(machine.model, machine.state, machine.acceleration)
                                                        : read(machine.model, machine.state);
  apply_gains(machine.model.parameters.sensors, readings);
  return readings;
}

double rope_angle(const Machine& machine) {
  const double angle = rope_angle(machine.model, machine.state);
  if (machine.motion.hoisting.is_still()) return angle;
  return angle * machine.model.parameters.load.rope_length / rope_length(machine.motion, time_of(machine));
}

double time_of(const Machine& machine) {
  return machine.started_at + static_cast<double>(machine.state.step_count) * machine.model.step;
}

bool switch_effect(Machine& machine, std::string_view name, bool on) {
  const auto found = std::find(machine.switchable.begin(), machine.switchable.end(), name);
  if (name.empty() || found == machine.switchable.end()) return false;
  machine.is_on[static_cast<std::size_t>(found - machine.switchable.begin())] = on;
  return true;
}

void rest_under_steady_forces(Machine& machine) {
  const PlantModel& model = machine.model;
  PlantState& state = machine.state;
  if (machine.force.empty()) return;
  EffectMoment rest;
  rest.time = time_of(machine);
  rest.step = model.step;
  rest.motor_angle = state.motor_angle;
  rest.house_angle = state.house_angle;
  rest.tip_displacement = rest.load_displacement = state.tip_displacement;
  PortForces& ports = machine.steady;
  const auto hangs_aslant = [&] { return ports.load_force != 0.0 || ports.rod_moment != 0.0; };
  const bool hung_aslant = hangs_aslant();
  ports = {};
  for (const std::size_t i : machine.force) EffectHandle(machine.effects[i])->force(rest, ports);  // a copy's: the run has not begun
  if (!model.has_load || (!hung_aslant && !hangs_aslant())) return;
  const Eigen::Matrix2d& stiffness = model.load.stiffness;
  const Eigen::Vector2d place(state.tip_displacement + ports.load_force / stiffness(0, 0),
                              stiffness(1, 1) > 0.0 ? ports.rod_moment / stiffness(1, 1) : 0.0);
  const Eigen::Vector2d q = model.load.modes.transpose() * (model.load.mass * place);
  state.load_q = {q(0), q(1)};
  refresh(model, state);
}

void begin_effects(Machine& machine, double outwards, double outward_rate) {
  for (EffectHandle& effect : machine.effects) effect->begin({machine.state.house_speed, outwards, outward_rate});
}

void forget_past(Machine& machine) {
  machine.has_past = machine.has_acceleration = false;
  if (!is_sensed(machine)) return;
  machine.acceleration = accelerations(machine.model, machine.state);
  machine.has_acceleration = true;
  sense(machine);
}

}  // namespace slewlab::sim
