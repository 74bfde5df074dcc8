#pragma once

// What must happen in a scenario with faults (`expect:` of its file), and whether it did, by the run's log. Only what
// is named is checked.

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "sim/drive/drive_fault.h"

namespace slewlab::msgs {
struct RunLog;
}

namespace slewlab::sim {

struct CountRange {
  std::int64_t at_least = 0;
  std::int64_t at_most = std::numeric_limits<std::int64_t>::max();
  bool operator==(const CountRange&) const = default;
};

struct FaultExpectation {
  std::optional<DriveState> drive_state;  // at the end
  std::optional<DriveFault> trip_cause;   // at the end
  struct FaultCount {
    DriveFault fault = DriveFault::none;
    CountRange count;
    bool operator==(const FaultCount&) const = default;
  };
  std::vector<FaultCount> faults;             // seen until the end
  bool no_other_faults = false;               // all those not named above were never seen
  std::optional<CountRange> stale_commands;
  std::optional<double> tip_acceleration;     // [m/s^2] largest size over the run, at most
  std::optional<std::int64_t> standing_by;    // [ns] from then on the slew angle stays within standing_angle
  double standing_angle = 0.0;                // [rad] standing_angle_of() the machine
  std::optional<double> slew_angle_at_least;  // [rad] at the end
  std::optional<double> slew_angle_at_most;   // [rad] at the end
  bool operator==(const FaultExpectation&) const = default;
};

// One line for everything that did not happen as expected; empty if all did.
std::vector<std::string> broken_expectations(const FaultExpectation& expectation, const msgs::RunLog& log);

}  // namespace slewlab::sim
