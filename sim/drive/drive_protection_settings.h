#pragma once

// How the drive protects the crane: `drive_protection:` of a crane's YAML. What it does with these: drive_protection.h.

#include <cstdint>
#include <limits>

namespace slewlab::sim {

inline constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();  // [ns]

struct BrakeSettings {
  double torque = 0.0;                 // [Nm] per motor, on the fast axis; 0 is a drive without brakes
  std::int64_t closing_delay = 0;      // [ns]
  double closing_time_constant = 0.0;  // [s]; 0 is at once
  std::int64_t release_delay = 0;      // [ns]
  double release_time_constant = 0.0;  // [s]; 0 is at once
};

// The defaults protect nothing.
struct DriveProtectionSettings {
  double torque_limit = std::numeric_limits<double>::infinity();       // [Nm] per motor
  double torque_rate_limit = std::numeric_limits<double>::infinity();  // [Nm/s] per motor, from answer to answer
  std::int64_t alive_timeout = kNever;                                 // [ns]
  std::int64_t silence_timeout = kNever;                               // [ns]
  int answer_age_limit = 0;  // [cycles] an answer to an ENCODER older than this is one to a wrong sequence number
  double standstill_speed = 0.0;     // [rad/s] of the motor shaft, below which the motors stand still
  bool trip_on_group_lost = true;    // otherwise the other groups carry on alone
  BrakeSettings brake;
};

}  // namespace slewlab::sim
