// What a plant of one's own is told of its run, and what its log must show (docs/wire.md, "What a plant must do").
//
// plant_task.json, beside the run's scenario.yaml: bus, log (file to write), machine (file), group_count, configuration_hash, run_identity
// (as the messages carry them, 64 bits with sign), duration_ns, controller_period_ns, plant_step_ns, sensors_period_ns, truth_period_ns,
// status_period_ns, and operator: [{time_ns, speed_request, emergency_stop, acknowledge}], by rising times, all of it from its time on.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "sim/drive/scenario_file.h"

namespace slewlab::tools {

inline constexpr const char* kPlantTaskName = "plant_task.json";

// Why a plant of one's own cannot run this scenario; empty where it can.
std::string why_not_by_another_plant(const sim::Scenario& scenario);

// Writes folder/plant_task.json; answers with its path. Throws std::runtime_error.
std::filesystem::path write_plant_task(const std::filesystem::path& folder, const sim::Scenario& scenario, const std::string& bus,
                                       const std::filesystem::path& log);

// Of a log that the plant has written to the end: what summary.json says of a run. Throws std::runtime_error in words where it is not
// this run, whole.
nlohmann::ordered_json own_plant_summary(const std::filesystem::path& log, const sim::Scenario& scenario);

}  // namespace slewlab::tools
