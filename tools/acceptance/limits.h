#pragma once

// What a controller must keep to be accepted (config/acceptance). Every limit is optional: what is not named is not
// checked.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/yaml_file.h"
#include "common/yaml_reader.h"

namespace slewlab::tools {

struct AcceptanceLimits {
  // The machine, as the controller was commissioned for it.
  double top_speed = 0.0;     // [rad/s] slew axis
  double rated_torque = 0.0;  // [Nm] per motor, T100

  std::optional<double> wrong_way;         // [-] of top speed, against the requested direction
  std::optional<double> overshoot;         // [-] of top speed, past the requested speed
  double settled_within = 0.05;            // [-] of top speed
  std::optional<double> settling_time;     // [s] from a request until the speed stays within
  std::optional<int> play_crossings;       // of all gearboxes together, before the emergency stop
  std::optional<double> play_offset;       // [-] of T100, least half difference of the halves' torques while ...
  double play_offset_up_to = 0.0;          // [-] of T100 ... the mean torque is below this
  std::optional<double> sidelead;          // [rad] before the emergency stop
  std::optional<double> torque_share;      // [-] of T100, before the emergency stop
  std::optional<double> stop_distance;     // [rad] slewed from the emergency stop to standstill
  std::optional<double> stop_time;         // [s] from the emergency stop until the speed stays within settled_within
  std::optional<double> stop_overshoot;    // [-] of top speed, past zero in the emergency stop
  std::optional<double> tip_acceleration;  // [m/s^2] after the emergency stop
  std::optional<int> trips;                // of the drive, where the scenario has no faults
  std::optional<double> standstill_after_trip;  // [s]
  std::optional<double> dead_time;         // [s] from a reading to the first torque that it moves
};

// The limits of an opened file, but for finish().
AcceptanceLimits read_acceptance_limits(common::YamlReader& reader);

// Throws common::InputError with every problem found.
AcceptanceLimits load_acceptance_limits(const std::filesystem::path& file, const std::vector<common::Override>& overrides = {});

}  // namespace slewlab::tools
