#include "sim/drive/scenario_run.h"

#include "common/effect.h"
#include "msgs/configuration_hash.h"
#include "msgs/run_identity.h"
#include "sim/effects/catalogue.h"

namespace slewlab::sim {
namespace {

constexpr double kNanosecondsPerSecond = 1e9;

}  // namespace

MachineSettings machine_settings(const MachineFile& crane) {
  MachineSettings settings;
  settings.crane = crane.parameters;
  settings.drive_protection = crane.drive_protection;
  if (crane.effects.kind == common::YamlNode::Kind::null) return settings;
  common::InputProblems problems;
  settings.effects = common::read_effects(crane.effects, effects_for(crane), problems);
  if (!problems.empty()) throw common::InputError(problems);
  return settings;
}

MachineSettings machine_settings(const Scenario& scenario) {
  MachineSettings settings = machine_settings(scenario.crane);
  settings.step = static_cast<double>(scenario.plant_step) / kNanosecondsPerSecond;
  settings.seed = static_cast<std::uint64_t>(scenario.seed);
  settings.effect_switches = scenario.effect_switches;
  settings.motion_requests = scenario.motion_requests;
  settings.steps_per_boom_angle = static_cast<int>(scenario.controller_period / scenario.plant_step);
  return settings;
}

LockstepSettings lockstep_settings(const Scenario& scenario) {
  LockstepSettings settings;
  settings.plant_step = scenario.plant_step;
  settings.controller_period = scenario.controller_period;
  settings.duration = scenario.duration;
  settings.sensors_period = scenario.sensors_period;
  settings.truth_period = scenario.truth_period;
  settings.status_period = scenario.status_period;
  settings.operator_moves = scenario.moves;
  settings.faults = scenario.faults;
  settings.configuration_hash = msgs::configuration_hash(scenario.configuration_text);
  settings.run_identity = msgs::run_identity(settings.configuration_hash);
  // A hundred milliseconds or, with a coarser step, the next whole number of steps.
  settings.live_period = (settings.live_period + settings.plant_step - 1) / settings.plant_step * settings.plant_step;
  return settings;
}

DriveRun drive_run(const Scenario& scenario) {
  const std::int64_t hash = msgs::configuration_hash(scenario.configuration_text);
  return {scenario.crane.parameters.drive.group_count, hash, scenario.controller_period, msgs::run_identity(hash)};
}

}  // namespace slewlab::sim
