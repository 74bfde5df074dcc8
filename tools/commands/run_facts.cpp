#include "tools/commands/run_facts.h"

#include <algorithm>
#include <cmath>

#include "msgs/configuration_hash.h"
#include "sim/analysis/eigen.h"
#include "sim/drive/scenario_run.h"
#include "sim/effects/catalogue.h"
#include "sim/machine/description.h"
#include "tools/commands/plant_task.h"
#include "tools/commands/whole_file.h"

namespace slewlab::tools {
namespace {

// A finer mesh moves no mode that a report shows, and takes the cube of its elements: minutes from a thousand on.
sim::CraneParameters meshed(sim::CraneParameters crane) {
  constexpr int kMostElements = 64;
  crane.boom.element_count = std::min(crane.boom.element_count, kMostElements);
  return crane;
}

// Names of the machine's effects that a steered run can switch.
nlohmann::ordered_json switchable_effects(const sim::Scenario& scenario) {
  nlohmann::ordered_json names = nlohmann::ordered_json::array();
  for (const common::EffectInstance& effect : sim::machine_settings(scenario.crane).effects) {
    const sim::EffectDescription* description = sim::find_effect(effect.name);
    if (description == nullptr || description->start == nullptr) continue;
    const auto& ports = description->ports;
    if (std::find(ports.begin(), ports.end(), sim::EffectPort::parameters) == ports.end()) names.push_back(effect.name);
  }
  return names;
}

}  // namespace

nlohmann::ordered_json machine_facts(const sim::MachineFile& machine) {
  const sim::MachineDescription description = sim::describe(machine);
  nlohmann::ordered_json facts;
  facts["kind"] = description.kind;
  facts["is_rigid"] = machine.parameters.drive.is_rigid;
  facts["ratio"] = description.scales.ratio;
  facts["axis_torque"] = description.scales.axis_torque;
  facts["axis_inertia"] = description.scales.axis_inertia;
  facts["top_speed"] = description.scales.top_speed;
  if (machine.kind == sim::MachineKind::axis) {
    facts["position_unit"] = machine.axis.is_linear ? "m" : "rad";
    facts["speed_unit"] = machine.axis.is_linear ? "m/s" : "rad/s";
  }
  const auto list = [](const auto& ports) {
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    for (const auto& port : ports) all.push_back({{"name", port.name}, {"unit", std::string(common::name_of(port.unit))}});
    return all;
  };
  facts["efforts"] = list(description.efforts);
  facts["sensors"] = list(description.sensors);
  for (std::size_t i = 0; i < description.sensors.size(); ++i) {
    facts["sensors"][i]["channel"] = std::string(description.sensors[i].channel);
    facts["sensors"][i]["field"] = std::string(description.sensors[i].field);
  }
  return facts;
}

std::string run_facts(const sim::Scenario& scenario,
                      const std::optional<controller::ControllerSettings>& controller, const RunOutcome& outcome) {
  constexpr double kNanosecondsPerSecond = 1e9;
  const sim::CraneParameters& crane = scenario.crane.parameters;

  nlohmann::ordered_json modes = nlohmann::ordered_json::array();
  for (const sim::Mode& mode : sim::crane_modes(meshed(crane))) {
    if (mode.kind == sim::ModeKind::kRigid) continue;
    const bool is_axis = scenario.crane.kind == sim::MachineKind::axis;
    modes.push_back({{"name", is_axis ? "transmission" : std::string(sim::name_of(mode.kind)) + " " + std::to_string(mode.count)},
                     {"frequency", mode.frequency},
                     {"damping_ratio", mode.damping_ratio}});
  }

  nlohmann::ordered_json facts;
  facts[std::string(sim::name_of(scenario.crane.kind))] = scenario.crane_file.lexically_normal().string();
  facts["controller"] = scenario.controller_file.lexically_normal().string();
  facts["configuration_hash"] = msgs::hash_text(msgs::configuration_hash(scenario.configuration_text));
  if (controller) {
    facts["rated_torque"] = controller->rated_torque;
    facts["torque_limit"] = controller->limits.torque;
    facts["total_ratio"] = controller->total_ratio;
    facts["top_speed"] = controller->ramp.top_speed;
    facts["play_compensation"] = controller->play_compensation.enabled;
  }
  facts["machine"] = machine_facts(scenario.crane);
  facts["switchable_effects"] = switchable_effects(scenario);
  facts["half_play"] = sim::gear_contact(crane).half_play;
  if (crane.boom.length > 0.0) {
    facts["tip_radius"] = crane.boom.pivot_radius + crane.boom.length * std::cos(crane.boom.angle);
    facts["geometry"] = {{"pivot_radius", crane.boom.pivot_radius},
                         {"boom_length", crane.boom.length},
                         {"boom_angle", crane.boom.angle},
                         {"rope_length", crane.load.rope_length},
                         {"rod_length", crane.load.rod_length}};
  }
  facts["plant_step"] = static_cast<double>(scenario.plant_step) / kNanosecondsPerSecond;
  facts["controller_period"] = static_cast<double>(scenario.controller_period) / kNanosecondsPerSecond;
  facts["duration"] = static_cast<double>(scenario.duration) / kNanosecondsPerSecond;
  facts["modes"] = std::move(modes);
  facts["simulated_time"] = outcome.simulated_time;
  facts["wall_time"] = outcome.wall_time;
  facts["cycles"] = outcome.cycles;
  facts["resends"] = outcome.resends;
  facts["controller_command"] = outcome.controller_command;
  facts["end"] = outcome.end;
  return facts.dump(2) + "\n";
}

void write_run_facts(const std::filesystem::path& folder, const sim::Scenario& scenario,
                     const std::optional<controller::ControllerSettings>& controller, const RunOutcome& outcome) {
  write_whole_file(folder / kRunFactsName, run_facts(scenario, controller, outcome));
}

void remove_earlier_run(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  for (const char* stale : {"summary.json", kRunFactsName, kPlantTaskName, "run.lcmlog", "run.lcmlog.partial", "report.html", "run.html",
                            "acceptance.json", "acceptance.html", "run.mcap", "plant.txt", "controller.txt"}) {
    fs::remove(folder / stale);
  }
  for (const char* format : {"parquet", "csv"}) {
    const fs::path exported = folder / (std::string("run_") + format);
    if (!fs::is_directory(exported)) continue;
    const auto is_ours = [&](const fs::directory_entry& entry) { return entry.path().extension() == std::string(".") + format; };
    if (std::all_of(fs::directory_iterator(exported), fs::directory_iterator(), is_ours)) fs::remove_all(exported);
  }
}

}  // namespace slewlab::tools
