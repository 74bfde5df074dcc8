#pragma once

// One task of a soak, run through the real loop (sim/drive/lockstep_loop.h: messages encoded and decoded, drive
// protection, faults on purpose) with the real controller behind a bus in memory, and watched all along. The log and
// the task's scenario lie in a folder of its own.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/yaml_file.h"
#include "tools/soak/invariants.h"
#include "tools/soak/settings.h"
#include "tools/soak/task_draw.h"

namespace slewlab::tools {

// The same for all tasks of a campaign.
struct SoakPlan {
  SoakSettings settings;
  std::filesystem::path crane;
  std::filesystem::path controller;
  std::vector<common::Override> overrides;  // crane.KEY and controller.KEY, before what a task changes
  bool faults = false;
  std::uint64_t seed = 0;
};

struct TaskResult {
  std::int64_t number = 0;
  bool complete = false;          // false: asked to stop
  std::int64_t simulated_time = 0;  // [ns]
  std::string description;
  std::uint64_t log_digest = 0;  // FNV-1a over all events: channel, time stamp, bytes
  std::int64_t log_events = 0;
  std::int64_t trips = 0;
  std::int64_t play_crossings = 0;
  double energy_error = 0.0;  // [-] largest, of the energy turned over
  double house_speed = 0.0;   // [rad/s] largest
  double sidelead = 0.0;      // [rad] largest
  std::vector<Violation> violations;
};

// Runs task `number`; asked often, `stop` ends it early. Writes folder/task.yaml and folder/run.lcmlog and leaves them
// there. Throws common::InputError, msgs::LogError; whatever else is thrown on the way is a violation of `finished`.
TaskResult run_task(const SoakPlan& plan, std::int64_t number, const std::filesystem::path& folder,
                    const std::function<bool()>& stop);

// Makes the folder of a task one that `slewlab run`, `replay` and `report` take: scenario.yaml, crane.yaml and
// controller.yaml with everything drawn worked in.
void keep_configuration(const SoakPlan& plan, std::int64_t number, const std::filesystem::path& folder);

// Crane, controller and settings as one text: equal text, equal tasks.
std::string plan_text(const SoakPlan& plan);

}  // namespace slewlab::tools
