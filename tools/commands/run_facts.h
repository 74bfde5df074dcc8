// What a report must know of a run beyond its log: run.json, beside run.lcmlog. Written by whoever ran it.
//
// Keys, in SI units: crane or axis, controller (files), machine (description: kind, efforts, sensors),  configuration_hash (16 hex digits), rated_torque and torque_limit
// [Nm per motor], total_ratio, top_speed [rad/s, slew axis], play_compensation, switchable_effects (names), half_play [rad, slew axis],
// tip_radius [m], geometry {pivot_radius, boom_length, rope_length, rod_length [m], boom_angle [rad]} of a crane with a boom, plant_step, controller_period, duration [s], modes [{name, frequency [Hz], damping_ratio}] of the
// whole crane with closed gears, simulated_time, wall_time [s], cycles, resends, controller_command, end.
// Without controller settings (a controller of one's own with a YAML of its own) the keys that come from them
// are left out.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "controller/controller.h"
#include "sim/drive/scenario_file.h"

namespace slewlab::tools {

// How a run went.
struct RunOutcome {
  double simulated_time = 0.0;  // [s] reached
  double wall_time = 0.0;       // [s] from the first ENCODER to the last answer
  std::int64_t cycles = 0;      // controller periods
  std::int64_t resends = 0;     // of an unanswered ENCODER
  std::string controller_command = "slewlab-controller";
  std::string end = "complete";  // or why it ended early
};

inline constexpr const char* kRunFactsName = "run.json";

// What a report must know of the machine: kind, names and units of what pushes and what is measured.
nlohmann::ordered_json machine_facts(const sim::MachineFile& machine);

// The facts as JSON text.
std::string run_facts(const sim::Scenario& scenario,
                      const std::optional<controller::ControllerSettings>& controller, const RunOutcome& outcome);

// Writes them to folder/run.json, whole or not at all. Throws std::runtime_error where that fails.
void write_run_facts(const std::filesystem::path& folder, const sim::Scenario& scenario,
                     const std::optional<controller::ControllerSettings>& controller, const RunOutcome& outcome);

// What an earlier run left, and what was drawn or exported of it: none of it may be taken for the new run's. A folder of exports goes
// only if nothing else is in it.
void remove_earlier_run(const std::filesystem::path& folder);

}  // namespace slewlab::tools
