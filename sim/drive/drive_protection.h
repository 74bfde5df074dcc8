#pragma once

// The drive as the crane's keeper: what a variable frequency drive with its brakes makes of what it receives, in
// simulated time alone. A pure function of settings, state, received message or silence, and simulated time; it
// allocates nothing and throws nothing. docs/drive.md has the state diagram, docs/wire.md the fault codes.
//
// What is wrong with a command is told apart, counted, and answered in one of three ways:
//   limit  torque beyond the limit, torque changing faster than the limit: brought within the limit and taken
//   hold   bytes that are no TORQUE of this run, an answer to a wrong ENCODER: not taken, the last command is held;
//          when no good command came for `silence_timeout`, the drive trips, and the cause is what was last refused
//   trip   not a number, infinity, wrong number of motor groups, alive counter frozen for `alive_timeout`, a motor
//          group or the main power lost
// A trip takes the torque away at once and lets the brakes fall in. Torque is accepted again only after the motors
// stand still, the brakes hold, and the controller acknowledges (rising edge).
//
// Disk brake (thesis 2.5: a torque on the motors): spring-applied, one torque per motor that opposes motion and holds
// at rest. `closing_delay` after it is let go, the torque T rises as T' = (capacity - T) / closing_time_constant;
// `release_delay` after it is lifted, it falls as T' = -T / release_time_constant.

#include <array>
#include <cstdint>

#include "msgs/codec.h"
#include "sim/drive/drive_fault.h"
#include "sim/drive/drive_protection_settings.h"
#include "sim/integrate/machine_settings.h"

namespace slewlab::sim {

// What the drive knows about the run it is part of.
struct DriveRun {
  int group_count = 0;
  std::int64_t configuration_hash = 0;
  std::int64_t controller_period = 0;  // [ns]
  std::int64_t run_identity = 0;
};

struct BrakeState {
  bool applied = false;        // asked to close
  std::int64_t since = 0;      // [ns] when that was asked
  bool closing = false;        // what the plates do now: the request behind its delay
  double torque = 0.0;         // [Nm] per motor
};

struct DriveProtectionState {
  DriveState state = DriveState::ready;
  DriveFault trip_cause = DriveFault::none;
  std::array<std::int64_t, kDriveFaultCount> faults{};  // how often each was seen
  std::int64_t stale_commands = 0;                      // cycles that ended without a fresh command
  std::int64_t trips = 0;
  std::int64_t trip_time = -1;  // [ns] of the last one; -1: it never tripped

  std::int64_t asked_sequence = -1;  // of the newest ENCODER
  bool fresh = true;                 // a good command came since that ENCODER
  bool has_command = false;
  std::int64_t torque_sequence = 0;    // of the command held
  std::int64_t answered_sequence = 0;  // of the command held
  std::int64_t alive_counter = 0;
  std::int64_t last_command = 0;  // [ns] when the last good command came
  std::int64_t last_alive = 0;    // [ns] when the alive counter last advanced
  bool acknowledge = false;       // as the last good command had it
  GroupArray motor_torque{};      // [Nm] per motor, held; zero unless running
  DriveFault refused = DriveFault::none;  // the last refused message since the last good command
  bool silence_seen = false;              // this silence is counted
  bool power_loss_seen = false;
  std::array<bool, kMaximumGroupCount> group_loss_seen{};
  BrakeState brake;
};

// The world around the drive at one instant.
struct DriveMoment {
  std::int64_t time = 0;     // [ns] simulated
  GroupArray shaft_speed{};  // [rad/s] of the motors, as the drive itself knows them
  bool main_power = true;
  std::array<bool, kMaximumGroupCount> group_lost{};
};

// ENCODER `sequence` goes out.
void begin_cycle(DriveProtectionState& state, std::int64_t sequence);

// Something came on the channel TORQUE. `torque` is read only where the status is ok.
void receive(const DriveProtectionSettings& settings, const DriveRun& run, DriveProtectionState& state,
             const DriveMoment& moment, msgs::DecodeStatus status, const msgs::Torque& torque);

// What the motors and brakes do during the plant step of length `step` [ns] that begins at `moment`. The brake's
// torque is its mean over the step.
DriveCommand drive_command(const DriveProtectionSettings& settings, const DriveRun& run, DriveProtectionState& state,
                           const DriveMoment& moment, std::int64_t step);

// Advances the brake by `step` [ns]; answers with its mean torque [Nm per motor] over the step.
double brake_torque(const BrakeSettings& settings, BrakeState& state, bool apply, std::int64_t time, std::int64_t step);

}  // namespace slewlab::sim
