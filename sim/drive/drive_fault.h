#pragma once

// The drive's states and what it finds wrong: PLANT_STATUS carries them as numbers, files and people use the names.
// docs/wire.md says when each is seen, docs/drive.md what the drive does about it.

#include <array>
#include <cstddef>
#include <cstdint>

namespace slewlab::sim {

// drive_state of PLANT_STATUS.
enum class DriveState : std::int8_t { ready = 0, running = 1, tripped = 2, braked = 3 };
inline constexpr std::array<const char*, 4> kDriveStateNames{"ready", "running", "tripped", "braked"};

// Index into `faults` and value of trip_cause of PLANT_STATUS.
enum class DriveFault : std::int8_t {
  none = 0,
  truncated = 1,
  other_version = 2,
  garbage = 3,
  other_configuration = 4,
  wrong_sequence = 5,
  repeated_answer = 6,
  group_count = 7,
  not_a_number = 8,
  infinite = 9,
  torque_limit = 10,
  torque_rate = 11,
  alive_frozen = 12,
  silence = 13,
  group_lost = 14,
  power_lost = 15,
};
inline constexpr int kDriveFaultCount = 16;
inline constexpr std::array<const char*, kDriveFaultCount> kDriveFaultNames{
    "none",            "truncated",   "other_version", "garbage",  "other_configuration", "wrong_sequence",
    "repeated_answer", "group_count", "not_a_number",  "infinite", "torque_limit",        "torque_rate",
    "alive_frozen",    "silence",     "group_lost",    "power_lost"};

// Of any number that a log may hold.
inline const char* name_of(DriveState state) {
  const auto index = static_cast<std::size_t>(state);
  return index < kDriveStateNames.size() ? kDriveStateNames[index] : "unknown";
}
inline const char* name_of(DriveFault fault) {
  const auto index = static_cast<std::size_t>(fault);
  return index < kDriveFaultNames.size() ? kDriveFaultNames[index] : "unknown";
}

}  // namespace slewlab::sim
