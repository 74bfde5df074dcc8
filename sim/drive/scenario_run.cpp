#include "sim/drive/scenario_run.h"

#include "common/effect.h"
#include "msgs/configuration_hash.h"
#include "sim/effects/catalogue.h"

namespace slewlab::sim {
namespace {

constexpr double kNanosecondsPerSecond = 1e9;

}  // namespace

std::vector<common::EffectInstance> effects_of(const MachineFile& crane) {
  if (crane.effects.kind == common::YamlNode::Kind::null) return {};
  common::InputProblems problems;
  const auto effects = common::read_effects(crane.effects, effects_for(crane.parameters), problems);
  if (!problems.empty()) throw common::InputError(problems);
  return effects;
}

MachineSettings machine_settings(const Scenario& scenario) {
  MachineSettings settings;
  settings.crane = scenario.crane.parameters;
  settings.effects = effects_of(scenario.crane);
  settings.step = static_cast<double>(scenario.plant_step) / kNanosecondsPerSecond;
  settings.seed = static_cast<std::uint64_t>(scenario.seed);
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
  // A hundred milliseconds or, with a coarser step, the next whole number of steps.
  settings.live_period = (settings.live_period + settings.plant_step - 1) / settings.plant_step * settings.plant_step;
  return settings;
}

DriveRun drive_run(const Scenario& scenario) {
  return {scenario.crane.parameters.drive.group_count, msgs::configuration_hash(scenario.configuration_text),
          scenario.controller_period};
}

}  // namespace slewlab::sim
