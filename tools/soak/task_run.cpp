#include "tools/soak/task_run.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "common/input_error.h"
#include "controller/controller_file.h"
#include "diagnosis/loop/wire_loop.h"
#include "msgs/log_writer.h"
#include "sim/machine/machine_file.h"
#include "sim/machine/scales.h"
#include "sim/drive/crane_plant.h"
#include "sim/drive/lockstep_loop.h"
#include "sim/drive/scenario_run.h"
#include "sim/integrate/plant.h"
#include "tools/commands/resolved_configuration.h"
#include "tools/commands/whole_file.h"
#include "tools/soak/dissipation.h"

namespace slewlab::tools {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kMemoryLooks = 10;  // at memory, during a task

// FNV-1a, 64 bits (Fowler, Noll, Vo).
class Digest {
 public:
  void add(std::span<const std::uint8_t> bytes) {
    for (const std::uint8_t byte : bytes) value_ = (value_ ^ byte) * 0x100000001b3ULL;
  }
  void add(std::string_view text) { add({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}); }
  void add(std::int64_t number) {
    for (int shift = 0; shift < 64; shift += 8) {
      value_ = (value_ ^ (static_cast<std::uint64_t>(number) >> shift & 0xFF)) * 0x100000001b3ULL;
    }
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

void take_drive(const sim::CranePlant& plant, StepRecord& record) {
  const sim::DriveProtectionState& drive = plant.drive();
  record.commanded_torque = drive.motor_torque;
  record.answered_sequence = drive.answered_sequence;
  record.brake_torque = drive.brake.torque;
  record.drive_state = drive.state;
  record.trip_cause = drive.trip_cause;
}

void take_record(const sim::CranePlant& plant, const SoakFacts& facts, const sim::PlantConditions& conditions,
                 StepRecord& record) {
  const sim::PlantModel& model = plant.machine().model;
  const sim::PlantState& state = plant.machine().state;
  record.time = state.step_count * facts.plant_step;
  record.state_sum = 0.0;
  for (std::size_t k = 0; k < state.q.size(); ++k) record.state_sum += state.q[k] + state.v[k];
  record.motor_angle = state.motor_angle;
  record.motor_speed = state.motor_speed;
  record.gear_torque = state.gear_torque;
  record.motor_friction = state.motor_friction;
  record.contact = state.contact;
  record.play_crossings = state.play_crossings;
  record.contact_changes = state.contact_changes;
  record.unsplit_steps = state.unsplit_steps;
  record.unsolved_frictions = state.unsolved_frictions;
  record.house_angle = state.house_angle;
  record.house_speed = state.house_speed;
  record.rope_angle = sim::rope_angle(model, state);
  record.rod_angle = sim::rod_angle(model, state);
  record.mechanical_energy = sim::mechanical_energy(model, state);
  record.supplied_work = state.supplied_work;
  record.dissipated_power = gear_and_rope_dissipation(model, state);
  record.applied_torque = plant.machine().applied_torque;
  record.conditions = conditions;
  take_drive(plant, record);
}

// The crane, watched: hands everything on and checks what comes of it.
class WatchedPlant : public sim::DrivenPlant {
 public:
  WatchedPlant(sim::CranePlant& plant, const SoakFacts& facts, const SoakLimits& limits, Findings& findings)
      : plant_(plant),
        facts_(facts),
        limits_(limits),
        findings_(findings),
        now_(record_of(plant, facts)),
        before_(now_),
        modal_dissipation_(plant.machine().model, plant.machine().state),
        energy_(facts, limits, now_) {}

  void read_encoder(msgs::Encoder& message) override { plant_.read_encoder(message); }
  void begin_cycle(std::int64_t encoder_sequence) override { plant_.begin_cycle(encoder_sequence); }
  void receive(msgs::DecodeStatus status, const msgs::Torque& message) override {
    StepRecord before;
    before.drive_state = now_.drive_state;
    plant_.receive(status, message);
    take_drive(plant_, now_);
    check_drive(facts_, before, now_, true, findings_);
  }
  void step(const sim::PlantConditions& conditions) override {
    const sim::DriveState state = now_.drive_state;  // behind the last message
    plant_.step(conditions);
    take_record(plant_, facts_, conditions, now_);
    now_.dissipated_by_modes += modal_dissipation_.over_step(plant_.machine().state);
    StepRecord behind_message;
    behind_message.drive_state = state;
    check_finite(facts_, now_, findings_);
    check_torque_limit(facts_, now_, findings_);
    check_torque_rate(facts_, before_, now_, findings_);
    check_speed(facts_, limits_, now_, findings_);
    check_angles(facts_, limits_, now_, findings_);
    check_contact(facts_, before_, now_, findings_);
    check_friction(facts_, before_, now_, findings_);
    check_drive(facts_, behind_message, now_, false, findings_);
    energy_.check(now_, findings_);
    house_speed_ = std::max(house_speed_, std::fabs(now_.house_speed));
    sidelead_ = std::max(sidelead_, std::fabs(now_.rope_angle));
    before_ = now_;
  }
  void read_sensors(msgs::Sensors& message) override { plant_.read_sensors(message); }
  void read_truth(msgs::Truth& message) override { plant_.read_truth(message); }
  void read_status(msgs::PlantStatus& message) override { plant_.read_status(message); }

  const EnergyBalance& energy() const { return energy_; }
  double house_speed() const { return house_speed_; }
  double sidelead() const { return sidelead_; }

 private:
  static StepRecord record_of(const sim::CranePlant& plant, const SoakFacts& facts) {
    StepRecord record;
    take_record(plant, facts, {}, record);
    return record;
  }

  sim::CranePlant& plant_;
  const SoakFacts& facts_;
  const SoakLimits& limits_;
  Findings& findings_;
  StepRecord now_;
  StepRecord before_;  // the step before
  ModalDissipation modal_dissipation_;
  EnergyBalance energy_;
  double house_speed_ = 0.0;
  double sidelead_ = 0.0;
};

SoakFacts facts_of(const sim::CranePlant& plant, const sim::Scenario& scenario, const sim::LockstepSettings& loop) {
  const sim::Machine& machine = plant.machine();
  SoakFacts facts;
  facts.group_count = machine.model.group_count;
  facts.motors_per_group = machine.model.parameters.drive.motors_per_group;
  facts.ratio = machine.model.ratio;
  facts.step = machine.model.step;
  facts.gear = machine.model.gear;
  const sim::Scales scales = sim::scales_of(machine.model.parameters);
  facts.axis_energy = 0.5 * scales.axis_inertia * scales.top_speed * scales.top_speed;
  facts.top_speed = scales.top_speed;
  facts.protection = scenario.crane.drive_protection;
  facts.bare_actuators = machine.message.empty() && machine.actuator.empty();
  facts.bare_brakes = machine.friction.empty();
  facts.configuration_hash = loop.configuration_hash;
  facts.controller_period = loop.controller_period;
  facts.sensors_period = loop.sensors_period;
  facts.truth_period = loop.truth_period;
  facts.status_period = loop.status_period;
  facts.plant_step = loop.plant_step;
  take_faults(scenario.faults, facts);
  return facts;
}

// Memory within the run: from the first of the looks on it may not grow, but for the messages that faults hold back
// (their places are kept for the next ones).
class MemoryWatch {
 public:
  MemoryWatch(const SoakLimits& limits, const sim::LockstepSettings& loop, Findings& findings)
      : limits_(limits), interval_(std::max<std::int64_t>(1, loop.duration / kMemoryLooks)), findings_(findings) {
    constexpr std::int64_t kHeldPerKilobyte = 4;  // ENCODER and TORQUE with their places in three lists
    for (const sim::Fault& fault : loop.faults) {
      const std::int64_t end = std::min(fault.until, loop.duration);
      const std::int64_t stopped = std::max<std::int64_t>(0, end - fault.from) / loop.controller_period;
      if (fault.kind == sim::FaultKind::controller_stopped) limits_.heap_growth += stopped / kHeldPerKilobyte;
      if (fault.kind == sim::FaultKind::message_delayed) limits_.heap_growth += fault.cycles / kHeldPerKilobyte;
    }
  }
  void look(std::int64_t time) {
    if (time < next_) return;
    const MemoryUse now = memory_use();
    if (next_ == interval_) first_ = now;
    check_memory(limits_, first_, now, "at the beginning of this task", time, findings_);
    next_ += interval_;
  }

 private:
  SoakLimits limits_;
  std::int64_t interval_;
  Findings& findings_;
  std::int64_t next_ = interval_;
  MemoryUse first_;
};

void run(const sim::Scenario& scenario, const SoakLimits& limits, const fs::path& log_file,
         const std::function<bool()>& stop, Findings& findings, TaskResult& result) {
  controller::ControllerSettings settings =
      controller::load_controller_file(scenario.controller_file, scenario.controller_overrides).settings;
  settings.period = static_cast<double>(scenario.controller_period) * 1e-9;
  const sim::LockstepSettings loop = sim::lockstep_settings(scenario);
  sim::CranePlant crane(sim::machine_settings(scenario), sim::drive_run(scenario));
  const SoakFacts facts = facts_of(crane, scenario, loop);
  WatchedPlant plant(crane, facts, limits, findings);
  MessageInvariants messages(facts);
  MemoryWatch memory(limits, loop, findings);

  sim::LockstepHooks hooks;
  hooks.after_cycle = [&](const sim::LockstepCounts& counts) { memory.look(counts.simulated_time); };
  hooks.stop = stop;

  msgs::LogWriter log(log_file);
  Digest digest;
  const sim::LogSink sink = [&](const char* channel, std::int64_t timestamp_us, msgs::Bytes bytes) {
    log.append(channel, timestamp_us, bytes);
    digest.add(std::string_view(channel));
    digest.add(timestamp_us);
    digest.add(bytes);
    messages.look(channel, timestamp_us, bytes, findings);
  };
  const auto [counts, controller_is_dead] = diagnosis::run_wire_loop(loop, settings, plant, sink, hooks);
  log.finish();
  if (controller_is_dead) findings.add(Invariant::answered, counts.simulated_time, "the controller answers no more");
  if (!facts.faults && (counts.resends != 0 || counts.stale_answers != 0 || counts.wrong_answers != 0)) {
    findings.add(Invariant::untroubled, counts.simulated_time,
                 "without a fault on purpose " + std::to_string(counts.resends) + " questions were repeated, " +
                     std::to_string(counts.stale_answers) + " answers came twice, " +
                     std::to_string(counts.wrong_answers) + " were wrong");
  }
  result.simulated_time = counts.simulated_time;
  result.complete = counts.simulated_time >= loop.duration || controller_is_dead;
  result.log_digest = digest.value();
  result.log_events = log.event_count();
  result.trips = crane.drive().trips;
  for (int i = 0; i < facts.group_count; ++i) result.play_crossings += crane.machine().state.play_crossings[i];
  result.energy_error = plant.energy().largest_error();
  result.house_speed = plant.house_speed();
  result.sidelead = plant.sidelead();
}

// The task's own scenario file and everything laid over it.
struct TaskFiles {
  fs::path scenario;
  std::vector<common::Override> overrides;
};

std::vector<common::Override> overrides_of(const SoakPlan& plan, std::string_view way) {
  std::vector<common::Override> overrides = plan.overrides;
  return common::take_overrides(way, overrides);
}

sim::MachineFile plain_crane(const SoakPlan& plan) {
  return sim::load_machine_file(plan.crane, overrides_of(plan, "crane."));
}
controller::ControllerFile plain_controller(const SoakPlan& plan) {
  return controller::load_controller_file(plan.controller, overrides_of(plan, "controller."));
}

SoakTask drawn(const SoakPlan& plan, std::int64_t number, const sim::CraneParameters& crane) {
  return draw_task(plan.settings.ranges, crane, plain_controller(plan).settings.ramp, plan.faults, plan.seed, number);
}

TaskFiles write_task(const SoakPlan& plan, const SoakTask& task, const sim::CraneParameters& crane,
                     const fs::path& folder) {
  TaskFiles files{folder / "task.yaml", plan.overrides};
  for (common::Override& change : task_overrides(task, crane)) files.overrides.push_back(std::move(change));
  fs::create_directories(folder);
  write_whole_file(files.scenario, task_scenario(task, plan.settings.ranges, plan.crane, plan.controller));
  return files;
}

}  // namespace

TaskResult run_task(const SoakPlan& plan, std::int64_t number, const fs::path& folder,
                    const std::function<bool()>& stop) {
  const sim::CraneParameters crane = plain_crane(plan).parameters;
  const SoakTask task = drawn(plan, number, crane);
  TaskResult result;
  result.number = number;
  result.description = describe(task);
  const TaskFiles files = write_task(plan, task, crane, folder);
  const sim::Scenario scenario = sim::load_scenario_file(files.scenario, files.overrides);
  Findings findings;
  try {
    run(scenario, plan.settings.limits, folder / "run.lcmlog", stop, findings, result);
  } catch (const common::InputError&) {
    throw;
  } catch (const msgs::LogError&) {
    throw;
  } catch (const std::exception& error) {
    result.complete = true;
    findings.add(Invariant::finished, result.simulated_time, error.what());
  }
  result.violations = findings.violations();
  return result;
}

void keep_configuration(const SoakPlan& plan, std::int64_t number, const fs::path& folder) {
  const sim::CraneParameters crane = plain_crane(plan).parameters;
  const TaskFiles files = write_task(plan, drawn(plan, number, crane), crane, folder);
  write_resolved_configuration(files.scenario, files.overrides, folder);
  fs::remove(files.scenario);
}

std::string plan_text(const SoakPlan& plan) {
  return "soak " + plan.settings.canonical_text + "\ncrane " + plain_crane(plan).canonical_text + "\ncontroller " +
         plain_controller(plan).canonical_text + "\n";
}

}  // namespace slewlab::tools
