#pragma once

// What a soak draws and the bounds of what it checks: config/soak. docs/soak.md explains each.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/yaml_file.h"
#include "common/yaml_reader.h"

namespace slewlab::tools {

struct SoakRange {
  double lowest = 0.0;
  double highest = 0.0;
};

// What tasks are drawn from.
struct TaskRanges {
  std::int64_t duration = 0;           // [ns] of one task, a whole number of controller periods
  std::int64_t plant_step = 0;         // [ns]
  std::int64_t controller_period = 0;  // [ns]
  SoakRange boom_angle;                // [rad]
  SoakRange rope_length;               // [m]
  double largest_mass = 0.0;           // [kg]
  double largest_moment = 0.0;         // [Nm] weight of the load times its radius
  double no_load = 0.0;                // [-] share of tasks
  SoakRange hold;                      // [s] between two moves of the operator
  double emergency_stop = 0.0;         // [-] share of moves
  double watched_sidelead = 0.0;       // [rad] to which the operator lets the load swing
  int most_faults = 1;
  double longest_fault = 0.0;          // [s]
};

// Bounds of the invariants that the crane's own file does not give.
struct SoakLimits {
  double house_speed = 0.0;            // [rad/s]
  double sidelead = 0.0;               // [rad]
  double rod_angle = 0.0;              // [rad]
  double energy_error = 0.0;           // [-] of the energy turned over
  std::int64_t heap_growth = 0;        // [kB]
  std::int64_t resident_growth = 0;    // [kB]
};

struct SoakSettings {
  TaskRanges ranges;
  SoakLimits limits;
  std::string canonical_text;  // tells whether a journal belongs to these settings
};

// The settings of an opened file, but for finish().
void read_soak_settings(common::YamlReader& reader, SoakSettings& settings);

// Throws common::InputError with every problem found.
SoakSettings load_soak_settings(const std::filesystem::path& file,
                                const std::vector<common::Override>& overrides = {});

}  // namespace slewlab::tools
