#include "diagnosis/evaluation/truth_machine.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "diagnosis/evaluation/measure.h"
#include "diagnosis/evaluation/random.h"
#include "diagnosis/loop/loop.h"
#include "sim/effects/accelerometers.h"
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

sim::ReferenceMachine reference_machine(const TruthMachine& machine, const Structure& structure) {
  sim::ReferenceMachine reference{.crane = machine.crane, .group_inertia = {}, .gear = {}, .modes = structure.modes};
  for (int i = 0; i < machine.crane.drive.group_count; ++i) {
    reference.group_inertia[i] = sim::group_inertia(machine.crane.drive) * machine.inertia_share[i];
    sim::GearContact gear = sim::gear_contact(machine.crane);
    gear.stiffness *= machine.stiffness_share[i];
    gear.damping *= machine.damping_share[i];
    gear.half_play = std::max(0.0, gear.half_play + machine.added_half_play[i]);
    reference.gear[i] = gear;
  }
  return reference;
}

// The machine with its drive on the plant's side of the loop: wire and actuators, the reference, the sensors.
class TruthPlant : public MeasuredPlant {
 public:
  TruthPlant(TruthMachine& machine, std::int64_t steps_per_period, const RunOptions& options, TruthRun& run)
      : machine_(machine),
        groups_(machine.crane.drive.group_count),
        drive_run_{groups_, 0, steps_per_period * kBaseStepNs},
        structure_(make_structure(machine.crane, machine.structure)),
        reference_(sim::make_reference(reference_machine(machine, structure_), options.reference, make_extra(machine))),
        acceleration_(structure_.modes.frequency.size()),
        run_(run) {
    for (int a = 0; a < kAccelerometerCount; ++a) noise_.emplace_back(machine.noise, Random(options.noise_seed, "accelerometer", a));
    sim::hang_load(*reference_);
    Random phases(options.noise_seed, "encoder phase");
    for (int i = 0; i < groups_; ++i) encoders_.emplace_back(machine.counting, phases.uniform());
    measure();
  }

  void read_encoder(msgs::Encoder& message) override {
    message.group_count = groups_;
    message.shaft_speed.clear();
    message.shaft_position.clear();
    for (const CountingEncoder& encoder : encoders_) {
      message.shaft_speed.push_back(encoder.speed());
      message.shaft_position.push_back(encoder.position());
    }
  }
  void begin_cycle(std::int64_t encoder_sequence) override { sim::begin_cycle(drive_, encoder_sequence); }
  void receive(msgs::DecodeStatus status, const msgs::Torque& message) override {
    sim::receive(machine_.drive_protection, drive_run_, drive_, moment(), status, message);
  }

  // By one base step. What has failed on a crane is no part of a withheld case.
  void step(const sim::PlantConditions&) override {
    const sim::DriveCommand command = sim::drive_command(machine_.drive_protection, drive_run_, drive_, moment(), kBaseStepNs);
    if (command.brake_torque[0] > 0.0) {
      throw DriveStopped(fmt::format("at {:.3f} s its drive is {} ({}), and a withheld machine has no brakes", now(), sim::name_of(drive_.state),
                                     sim::name_of(drive_.trip_cause)));
    }
    GroupArray torque = command.motor_torque;
    for (const WireLaw& law : machine_.wire) law(now(), command.sequence, torque);
    for (const TorqueLaw& law : machine_.torque) law(now(), readings_.shaft_position, readings_.shaft_speed, torque);
    sim::advance(*reference_, torque, static_cast<double>(steps_ + 1) * kBaseStep);
    const std::int64_t changes = sim::counts(*reference_).contact_changes;
    if (changes != contact_changes_) run_.contact_change_times.push_back(now());
    contact_changes_ = changes;
    ++steps_;
    measure();
  }

  const GroupArray& true_speed() const { return readings_.shaft_speed; }
  sim::ReferenceCounts counts() const { return sim::counts(*reference_); }

 private:
  static constexpr auto& kFields = msgs::kSensorFields<SensorValues>;

  double now() const { return static_cast<double>(steps_) * kBaseStep; }

  sim::DriveMoment moment() const {
    sim::DriveMoment moment;
    moment.time = steps_ * kBaseStepNs;
    moment.shaft_speed = readings_.shaft_speed;
    return moment;
  }

  // What the sensors say at the end of a step.
  void measure() {
    readings_ = sim::read(*reference_);
    sim::modal_accelerations(*reference_, acceleration_.data());
    SensorValues truth;
    for (std::size_t s = 0; s < kFields.size(); ++s) {
      truth.*kFields[s].value = times(structure_.sensors[s], is_acceleration(kFields[s].unit) ? acceleration_.data() : sim::modal_coordinates(*reference_));
    }
    seen_ = truth;
    for (const SensorLaw& law : machine_.sensors) law(now(), truth, seen_);
    sim::apply_gains(machine_.crane.sensors, seen_);
    for (std::size_t a = 0; a < noise_.size(); ++a) seen_.*kAccelerometers<SensorValues>[a].value += noise_[a].next();
    seen_.slew_angle = machine_.noise.slew_resolution * std::round(seen_.slew_angle / machine_.noise.slew_resolution);
    GroupArray position = readings_.shaft_position;
    for (const EncoderLaw& law : machine_.encoder) law(now(), position);
    for (std::size_t i = 0; i < encoders_.size(); ++i) encoders_[i].update(position[i]);
  }

  TruthMachine& machine_;
  int groups_;
  sim::DriveRun drive_run_;
  sim::DriveProtectionState drive_;
  Structure structure_;
  sim::ReferencePointer reference_;
  std::vector<double> acceleration_;  // [m/s^2] modal
  std::vector<ColouredNoise> noise_;  // of the accelerometers
  std::vector<CountingEncoder> encoders_;
  std::int64_t steps_ = 0;
  std::int64_t contact_changes_ = 0;
  sim::PlantReadings readings_;
  TruthRun& run_;
};

std::int64_t steps_per_period(const TruthMachine& machine) {
  const auto steps = static_cast<std::int64_t>(std::llround(machine.controller.period / kBaseStep));
  if (steps < 1 || std::fabs(static_cast<double>(steps) * kBaseStep - machine.controller.period) > 1e-12) {
    throw std::invalid_argument("the controller's period must be a whole number of milliseconds");
  }
  return steps;
}

}  // namespace

void MeasuredPlant::read_sensors(msgs::Sensors& message) {
  for (std::size_t s = 0; s < msgs::kSensorFields<SensorValues>.size(); ++s) {
    message.*msgs::kSensorFields<msgs::Sensors>[s].value = seen_.*msgs::kSensorFields<SensorValues>[s].value;
  }
}

std::vector<sim::OperatorMove> moves_of(const Manoeuvre& manoeuvre) {
  std::vector<sim::OperatorMove> moves;
  for (const Request& request : manoeuvre.requests) {
    moves.push_back({.time = std::llround(request.time * 1e9), .speed_request = request.speed_request});
  }
  return moves;
}

void keep_cycle(const msgs::Encoder& encoder, const msgs::Torque& torque, const GroupArray& true_speed, TruthRun& run) {
  for (std::size_t i = 0; i < encoder.shaft_speed.size(); ++i) {
    run.shaft_speed[i].push_back(encoder.shaft_speed[i]);
    run.shaft_position[i].push_back(encoder.shaft_position[i]);
    run.motor_torque[i].push_back(torque.motor_torque[i]);
    run.true_speed[i].push_back(true_speed[i]);
  }
  run.enable.push_back(torque.enable);
  run.brake.push_back(torque.brake);
}

TruthRun run_truth(TruthMachine machine, const Manoeuvre& manoeuvre, const RunOptions& options) {
  if (machine.controller.group_count != machine.crane.drive.group_count) {
    throw std::invalid_argument("crane and controller differ in their number of motor groups");
  }
  LoopCourse course;
  course.plant_step = kBaseStep;
  course.steps_per_period = steps_per_period(machine);
  course.steps = std::llround(manoeuvre.duration / kBaseStep);
  course.ends_with_answer = true;
  course.operator_moves = moves_of(manoeuvre);
  TruthRun run;
  run.group_count = machine.crane.drive.group_count;
  run.cycle_steps = course.steps_per_period;
  run.manoeuvre = manoeuvre;
  TruthPlant plant(machine, course.steps_per_period, options, run);
  ControllerAnswer controller(machine.controller);
  LoopHooks hooks;
  hooks.answered = [&](const LoopMoment& moment) { keep_cycle(moment.encoder, controller.torque(), plant.true_speed(), run); };
  hooks.instant = [&](const LoopMoment&) { run.sensors.push_back(plant.sensors()); };
  run_loop(course, plant, std::ref(controller), hooks);
  run.counts = plant.counts();
  return run;
}

}  // namespace slewlab::diagnosis::withheld
