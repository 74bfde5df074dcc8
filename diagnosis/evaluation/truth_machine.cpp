#include "diagnosis/evaluation/truth_machine.h"

#include <cmath>
#include <stdexcept>

#include "diagnosis/evaluation/measure.h"
#include "diagnosis/evaluation/random.h"
#include "sim/model/boom.h"
#include "sim/model/drive_line.h"

namespace slewlab::diagnosis::withheld {

TruthMachine make_truth_machine(const sim::CraneParameters& crane, const controller::ControllerSettings& controller) {
  TruthMachine machine;
  machine.crane = crane;
  machine.scales = law_scales(crane, controller);
  machine.crane.boom.element_count = kTruthElementCount;
  machine.controller = controller;
  machine.inertia_share.fill(1.0);
  machine.stiffness_share.fill(1.0);
  machine.damping_share.fill(1.0);
  return machine;
}

namespace {

sim::ReferenceExtra make_extra(const TruthMachine& machine) {
  sim::ReferenceExtra extra;
  const sim::CraneParameters& crane = machine.crane;
  const int groups = crane.drive.group_count;
  const double radius = sim::tip_radius(crane.boom);
  const double rope = crane.load.mass > 0.0 ? crane.load.mass * sim::kGravity / crane.load.rope_length : 0.0;
  for (const ForceLaw& law : machine.forces) {
    extra.start.insert(extra.start.end(), law.start.begin(), law.start.end());
    extra.scale.insert(extra.scale.end(), law.scale.begin(), law.scale.end());
  }
  if (!machine.forces.empty()) {
    extra.forces = [laws = machine.forces, crane, groups, radius, rope](
                       const sim::ReferenceMotion& motion, const double* states, sim::ReferenceForces& forces,
                       double* rates) {
      const Scene scene{motion, crane, groups, radius, rope};
      for (const ForceLaw& law : laws) {
        law.act(scene, states, forces, rates);
        states += law.start.size();
        rates += law.start.size();
      }
    };
  }
  if (!machine.gears.empty()) {
    extra.gears = [laws = machine.gears, crane, groups, radius, rope](
                      const sim::ReferenceMotion& motion, const double*, sim::ReferenceGears& gears) {
      const Scene scene{motion, crane, groups, radius, rope};
      for (const GearLaw& law : laws) law(scene, gears);
    };
  }
  return extra;
}

double times(const std::vector<double>& shape, const double* values) {
  double sum = 0.0;
  for (std::size_t k = 0; k < shape.size(); ++k) sum += shape[k] * values[k];
  return sum;
}

}  // namespace

TruthRun run_truth(TruthMachine machine, const Manoeuvre& manoeuvre, const RunOptions& options) {
  const int groups = machine.crane.drive.group_count;
  if (machine.controller.group_count != groups) {
    throw std::invalid_argument("crane and controller differ in their number of motor groups");
  }
  const auto cycle_steps = static_cast<std::int64_t>(std::llround(machine.controller.period / kBaseStep));
  if (cycle_steps < 1 || std::fabs(static_cast<double>(cycle_steps) * kBaseStep - machine.controller.period) > 1e-12) {
    throw std::invalid_argument("the controller's period must be a whole number of milliseconds");
  }

  const Structure structure = make_structure(machine.crane, machine.structure);
  sim::ReferenceMachine reference_machine{
      .crane = machine.crane, .group_inertia = {}, .gear = {}, .modes = structure.modes};
  for (int i = 0; i < groups; ++i) {
    reference_machine.group_inertia[i] = sim::group_inertia(machine.crane.drive) * machine.inertia_share[i];
    sim::GearContact gear = sim::gear_contact(machine.crane);
    gear.stiffness *= machine.stiffness_share[i];
    gear.damping *= machine.damping_share[i];
    gear.half_play = std::max(0.0, gear.half_play + machine.added_half_play[i]);
    reference_machine.gear[i] = gear;
  }
  const sim::ReferencePointer reference =
      sim::make_reference(reference_machine, options.reference, make_extra(machine));
  sim::hang_load(*reference);

  Random phases(options.noise_seed, "encoder phase");
  std::vector<CountingEncoder> encoders;
  for (int i = 0; i < groups; ++i) encoders.emplace_back(machine.counting, phases.uniform());
  std::array<ColouredNoise, 4> noise{ColouredNoise(machine.noise, Random(options.noise_seed, "accelerometer", 0)),
                                     ColouredNoise(machine.noise, Random(options.noise_seed, "accelerometer", 1)),
                                     ColouredNoise(machine.noise, Random(options.noise_seed, "accelerometer", 2)),
                                     ColouredNoise(machine.noise, Random(options.noise_seed, "accelerometer", 3))};

  TruthRun run;
  run.group_count = groups;
  run.cycle_steps = cycle_steps;
  run.manoeuvre = manoeuvre;
  controller::ControllerState controller_state;
  controller::ControllerOutput command;
  std::vector<double> acceleration(structure.modes.frequency.size());
  std::size_t next_request = 0;
  double speed_request = 0.0;
  const auto steps = static_cast<std::int64_t>(std::llround(manoeuvre.duration / kBaseStep));
  for (std::int64_t n = 0; n <= steps; ++n) {
    const double now = static_cast<double>(n) * kBaseStep;
    const sim::PlantReadings readings = sim::read(*reference);
    sim::modal_accelerations(*reference, acceleration.data());
    const double* q = sim::modal_coordinates(*reference);
    SensorValues truth{.house = times(structure.house_sensor, acceleration.data()),
                       .pivot = times(structure.pivot_sensor, acceleration.data()),
                       .middle = times(structure.middle_sensor, acceleration.data()),
                       .tip = times(structure.tip_sensor, acceleration.data()),
                       .slew_angle = times(structure.slew_sensor, q)};
    SensorValues seen = truth;
    for (const SensorLaw& law : machine.sensors) law(now, truth, seen);
    seen.house += noise[0].next();
    seen.pivot += noise[1].next();
    seen.middle += noise[2].next();
    seen.tip += noise[3].next();
    seen.slew_angle = machine.noise.slew_resolution * std::round(seen.slew_angle / machine.noise.slew_resolution);
    run.sensors.push_back(seen);

    GroupArray position = readings.shaft_position;
    for (const EncoderLaw& law : machine.encoder) law(now, position);
    for (int i = 0; i < groups; ++i) encoders[static_cast<std::size_t>(i)].update(position[i]);

    if (n % cycle_steps == 0) {
      while (next_request < manoeuvre.requests.size() &&
             manoeuvre.requests[next_request].time <= now + 1e-6 * kBaseStep) {
        speed_request = manoeuvre.requests[next_request++].speed_request;
      }
      controller::ControllerInput input;
      input.simulated_time = n * std::llround(kBaseStep * 1e9);
      input.group_count = groups;
      input.speed_request = speed_request;
      for (int i = 0; i < groups; ++i) input.shaft_speed[i] = encoders[static_cast<std::size_t>(i)].speed();
      controller::step(machine.controller, controller_state, input, command);
      for (int i = 0; i < groups; ++i) {
        run.shaft_speed[i].push_back(encoders[static_cast<std::size_t>(i)].speed());
        run.shaft_position[i].push_back(encoders[static_cast<std::size_t>(i)].position());
        run.motor_torque[i].push_back(command.motor_torque[i]);
        run.true_speed[i].push_back(readings.shaft_speed[i]);
      }
      run.enable.push_back(command.enable);
      run.brake.push_back(command.brake);
    }
    if (n == steps) break;
    GroupArray torque{};
    for (int i = 0; i < groups; ++i) torque[i] = command.enable ? command.motor_torque[i] : 0.0;
    for (const WireLaw& law : machine.wire) law(now, n / cycle_steps, torque);
    for (const TorqueLaw& law : machine.torque) law(now, readings.shaft_position, readings.shaft_speed, torque);
    sim::advance(*reference, torque, static_cast<double>(n + 1) * kBaseStep);
    const std::int64_t changes = sim::counts(*reference).contact_changes;
    if (changes != run.counts.contact_changes) run.contact_change_times.push_back(now);
    run.counts.contact_changes = changes;
  }
  run.counts = sim::counts(*reference);
  return run;
}

}  // namespace slewlab::diagnosis::withheld
