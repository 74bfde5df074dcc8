#pragma once

// Faults on purpose: what a scenario's `faults:` schedules, each from `from` until `until` (simulated time). What draws
// numbers draws them by seed and sequence number of the message alone, so that lockstep runs repeat to the bit.

#include <array>
#include <cstdint>
#include <vector>

#include "sim/drive/drive_protection_settings.h"

namespace slewlab::sim {

enum class FaultKind {
  controller_killed,      // at `from`; started anew at `until`, if that comes
  controller_stopped,     // answers nothing, then everything that has come meanwhile
  message_lost,           // these five: each message of `channel` with `probability`
  message_delayed,        // by `cycles` controller periods
  message_duplicated,
  message_reordered,      // arrives behind the next one
  message_corrupted,
  encoder_frozen,         // these four: of `group`, or of all
  encoder_noisy,          // normally distributed, `speed` and `position` are the standard deviations
  encoder_offset,         // `speed` and `position` are added
  encoder_dropped,        // no signal: not a number
  motor_group_lost,       // the motors of `group` give no torque
  main_power_lost,        // no torque, and the brakes fall in
};
inline constexpr std::array kFaultKindNames{
    "controller_killed", "controller_stopped", "message_lost",    "message_delayed", "message_duplicated",
    "message_reordered", "message_corrupted",  "encoder_frozen",  "encoder_noisy",   "encoder_offset",
    "encoder_dropped",   "motor_group_lost",   "main_power_lost"};

enum class FaultChannel { encoder, torque };
inline constexpr std::array kFaultChannelNames{"ENCODER", "TORQUE"};

// What becomes of a corrupted message. Below `bits` and `truncated`, `garbage`, `other_version` only TORQUE.
enum class Corruption {
  bits,  // one bit is turned over
  truncated,
  garbage,
  other_version,
  other_configuration,
  wrong_sequence,
  group_count,
  not_a_number,
  infinite,
  torque_limit,
  alive_frozen,
};
inline constexpr std::array kCorruptionNames{
    "bits",        "truncated",    "garbage",  "other_version", "other_configuration", "wrong_sequence",
    "group_count", "not_a_number", "infinite", "torque_limit",  "alive_frozen"};

struct Fault {
  FaultKind kind = FaultKind::message_lost;
  std::int64_t from = 0;        // [ns]
  std::int64_t until = kNever;  // [ns]
  FaultChannel channel = FaultChannel::torque;
  double probability = 1.0;
  std::uint64_t seed = 0;
  std::int64_t cycles = 1;
  Corruption corruption = Corruption::bits;
  int group = -1;         // -1: all groups
  double speed = 0.0;     // [rad/s] motor shaft
  double position = 0.0;  // [rad] motor shaft
  double torque = 0.0;    // [Nm] per motor, of the corruption torque_limit: beyond any limit of the machine

  bool active(std::int64_t time) const { return time >= from && time < until; }
};

}  // namespace slewlab::sim
