#include "diagnosis/evaluation/known_laws.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "controller/effects/catalogue.h"
#include "diagnosis/evaluation/measure.h"
#include "sim/effects/catalogue.h"
#include "sim/machine/effect_scales.h"

namespace slewlab::diagnosis::withheld {

namespace {

using common::EffectAbout;
using common::EffectInstance;

EffectInstance instance_of(const EffectAbout& about, std::vector<TrueSize>& sizes) {
  EffectInstance instance = common::typical_instance(about);
  for (TrueSize& size : sizes) {
    for (std::size_t k = 0; k < about.parameters.size(); ++k) {
      if (about.parameters[k].name != size.parameter) continue;
      size.value = std::clamp(size.value, about.parameters[k].lower, about.parameters[k].upper);
      size.comparable = true;  // it is the catalogue's own number
      instance.values[k] = size.value;
    }
  }
  return instance;
}

// The plant, measured with sensors as they are bought.
class KnownPlant : public MeasuredPlant {
 public:
  KnownPlant(const KnownMachine& known, sim::CranePlant plant, std::uint64_t noise_seed)
      : plant_(std::move(plant)), groups_(known.machine.crane.drive.group_count), slew_resolution_(known.noise.slew_resolution) {
    for (int a = 0; a < kAccelerometerCount; ++a) noise_.emplace_back(known.noise, Random(noise_seed, "accelerometer", a));
    Random phases(noise_seed, "encoder phase");
    for (int i = 0; i < groups_; ++i) {
      counted_.emplace_back(known.counting, phases.uniform());
      followed_.emplace_back(EncoderCounting{.resolution = 0.0}, 0.0);
    }
    measure();
  }

  void read_encoder(msgs::Encoder& message) override {
    plant_.read_encoder(message);
    for (std::size_t i = 0; i < counted_.size(); ++i) {
      message.shaft_speed[i] += counted_[i].speed() - followed_[i].speed();
      message.shaft_position[i] = counted_[i].position();
    }
  }
  void begin_cycle(std::int64_t encoder_sequence) override { plant_.begin_cycle(encoder_sequence); }
  void receive(msgs::DecodeStatus status, const msgs::Torque& message) override { plant_.receive(status, message); }

  void step(const sim::PlantConditions& conditions) override {
    plant_.step(conditions);
    const sim::DriveProtectionState& drive = plant_.drive();
    if (drive.state == sim::DriveState::tripped || drive.state == sim::DriveState::braked) {
      throw DriveStopped(fmt::format("at {:.3f} s its drive is {} ({})", sim::time_of(plant_.machine()), sim::name_of(drive.state), sim::name_of(drive.trip_cause)));
    }
    measure();
  }

  // [rad/s] on the fast axis
  GroupArray true_speed() const {
    GroupArray speed{};
    for (int i = 0; i < groups_; ++i) speed[i] = plant_.machine().state.motor_speed[i] * plant_.machine().model.ratio;
    return speed;
  }
  std::int64_t contact_changes() const { return plant_.machine().state.contact_changes; }

 private:
  static constexpr auto& kFields = msgs::kSensorFields<SensorValues>;

  void measure() {
    const sim::PlantReadings readings = sim::read(plant_.machine());
    for (std::size_t s = 0; s < kFields.size(); ++s) seen_.*kFields[s].value = readings.*msgs::kSensorFields<sim::PlantReadings>[s].value;
    for (std::size_t a = 0; a < noise_.size(); ++a) seen_.*kAccelerometers<SensorValues>[a].value += noise_[a].next();
    seen_.slew_angle = slew_resolution_ * std::round(seen_.slew_angle / slew_resolution_);
    for (std::size_t i = 0; i < counted_.size(); ++i) {
      counted_[i].update(readings.shaft_position[i]);
      followed_[i].update(readings.shaft_position[i]);
    }
  }

  sim::CranePlant plant_;
  int groups_;
  double slew_resolution_;  // [rad]
  std::vector<ColouredNoise> noise_;  // of the accelerometers
  std::vector<CountingEncoder> counted_, followed_;
};

}  // namespace

bool has_known_laws(const DrawnCase& drawn) {
  return std::none_of(drawn.laws.begin(), drawn.laws.end(), [](const DrawnLaw& law) { return law_named(law.law).effect.empty(); });
}

KnownMachine known_machine(const DrawnCase& drawn, const NominalMachine& nominal, const sim::DriveProtectionSettings& drive_protection,
                           const std::vector<bool>& on, std::vector<std::vector<TrueSize>>* sizes) {
  std::vector<std::vector<TrueSize>> drawn_sizes;
  const TruthMachine withheld = build(drawn, nominal, on, &drawn_sizes);
  KnownMachine known;
  known.machine.crane = spread_crane(drawn, nominal);
  known.machine.step = kBaseStep;
  known.machine.scales = sim::effect_scales(nominal.description.machine, drive_protection);
  known.machine.drive_protection = drive_protection;
  known.noise = withheld.noise;
  const common::EffectCatalogue of_machine = sim::effects_for(known.machine), of_controller = controller::effects_for(nominal.controller);
  std::vector<EffectInstance> of_the_controller;
  std::size_t acting = 0;
  for (std::size_t k = 0; k < drawn.laws.size(); ++k) {
    if (!on[k]) continue;
    const std::string& effect = law_named(drawn.laws[k].law).effect;
    std::vector<TrueSize>& values = drawn_sizes[acting++];
    if (const EffectAbout* about = of_controller.find(effect)) {
      of_the_controller.push_back(instance_of(*about, values));
    } else {
      known.machine.effects.push_back(instance_of(of_machine.at(effect), values));
    }
  }
  known.controller = controller::with_effects(nominal.controller, of_the_controller);
  if (sizes != nullptr) *sizes = std::move(drawn_sizes);
  return known;
}

TruthRun run_known(const KnownMachine& known, const Manoeuvre& manoeuvre, std::uint64_t noise_seed) {
  LoopSettings settings{.machine = known.machine, .controller = known.controller, .operator_moves = moves_of(manoeuvre), .duration = manoeuvre.duration};
  settings.machine.seed = noise_seed;
  LoopCourse course = course_of(settings);
  course.ends_with_answer = true;
  TruthRun run;
  run.group_count = known.machine.crane.drive.group_count;
  run.cycle_steps = course.steps_per_period;
  run.manoeuvre = manoeuvre;
  KnownPlant plant(known, sim::CranePlant(settings.machine, drive_run(course, run.group_count)), noise_seed);
  ControllerAnswer controller(known.controller);
  std::int64_t contact_changes = 0;
  LoopHooks hooks;
  hooks.answered = [&](const LoopMoment& moment) { keep_cycle(moment.encoder, controller.torque(), plant.true_speed(), run); };
  hooks.instant = [&](const LoopMoment&) { run.sensors.push_back(plant.sensors()); };
  hooks.stepped = [&](const LoopMoment& moment) {
    if (plant.contact_changes() != contact_changes) run.contact_change_times.push_back(static_cast<double>(moment.step - 1) * kBaseStep);
    contact_changes = plant.contact_changes();
  };
  run_loop(course, plant, std::ref(controller), hooks);
  return run;
}

}  // namespace slewlab::diagnosis::withheld
