#include "sim/drive/drive_protection.h"

#include <algorithm>
#include <cmath>

namespace slewlab::sim {
namespace {

constexpr double kNanosecond = 1e-9;  // [s]
// The brakes hold once this share of their torque is there; lifted, what is left below the other share is let go.
constexpr double kBrakeHolds = 0.95;
constexpr double kBrakeOpen = 1e-3;

void count(DriveProtectionState& state, DriveFault fault) { ++state.faults[static_cast<std::size_t>(fault)]; }

void trip(DriveProtectionState& state, DriveFault cause, std::int64_t time) {
  if (state.trip_cause != DriveFault::none) return;  // the first cause stands
  state.state = DriveState::tripped;
  state.trip_cause = cause;
  state.motor_torque = {};
  ++state.trips;
  state.trip_time = time;
}

void refuse(DriveProtectionState& state, DriveFault fault) {
  count(state, fault);
  state.refused = fault;
}

DriveFault fault_of(msgs::DecodeStatus status) {
  switch (status) {
    case msgs::DecodeStatus::truncated: return DriveFault::truncated;
    case msgs::DecodeStatus::other_version: return DriveFault::other_version;
    default: return DriveFault::garbage;
  }
}

DriveFault unusable_number(const msgs::Torque& torque) {
  DriveFault found = DriveFault::none;
  for (const double value : torque.motor_torque) {
    if (std::isnan(value)) return DriveFault::not_a_number;
    if (std::isinf(value)) found = DriveFault::infinite;
  }
  return found;
}

bool lost_group(const DriveProtectionSettings& settings, const DriveRun& run, const DriveMoment& moment) {
  return settings.trip_on_group_lost &&
         std::any_of(moment.group_lost.begin(), moment.group_lost.begin() + run.group_count, [](bool lost) { return lost; });
}

// The torque asked for, brought within the limits of size and rate; each counts once per command.
void take_torque(const DriveProtectionSettings& settings, const DriveRun& run, DriveProtectionState& state,
                 const msgs::Torque& torque, std::int64_t cycles) {
  const double largest_change =
      settings.torque_rate_limit * static_cast<double>(cycles * run.controller_period) * kNanosecond;
  bool too_large = false;
  bool too_fast = false;
  for (int group = 0; group < run.group_count; ++group) {
    const double asked = torque.motor_torque[static_cast<std::size_t>(group)];
    const double within = std::clamp(asked, -settings.torque_limit, settings.torque_limit);
    const double before = state.motor_torque[group];
    const double reached = std::clamp(within, before - largest_change, before + largest_change);
    too_large = too_large || within != asked;
    too_fast = too_fast || reached != within;
    state.motor_torque[group] = reached;
  }
  if (too_large) count(state, DriveFault::torque_limit);
  if (too_fast) count(state, DriveFault::torque_rate);
}

}  // namespace

void begin_cycle(DriveProtectionState& state, std::int64_t sequence) {
  if (!state.fresh) ++state.stale_commands;
  state.fresh = false;
  state.asked_sequence = sequence;
}

void receive(const DriveProtectionSettings& settings, const DriveRun& run, DriveProtectionState& state,
             const DriveMoment& moment, msgs::DecodeStatus status, const msgs::Torque& torque) {
  if (status != msgs::DecodeStatus::ok) return refuse(state, fault_of(status));
  if (torque.configuration_hash != run.configuration_hash || torque.run_identity != run.run_identity) {
    return refuse(state, DriveFault::other_configuration);
  }
  if (state.has_command && torque.answered_sequence == state.answered_sequence) {
    return count(state, DriveFault::repeated_answer);
  }
  const bool older_than_held = state.has_command && torque.answered_sequence < state.answered_sequence;
  if (torque.answered_sequence > state.asked_sequence || older_than_held ||
      torque.answered_sequence < state.asked_sequence - settings.answer_age_limit) {
    return refuse(state, DriveFault::wrong_sequence);
  }
  if (torque.group_count != run.group_count) {
    count(state, DriveFault::group_count);
    return trip(state, DriveFault::group_count, moment.time);
  }
  if (const DriveFault fault = unusable_number(torque); fault != DriveFault::none) {
    count(state, fault);
    return trip(state, fault, moment.time);
  }

  if (state.has_command && torque.alive_counter == state.alive_counter) {
    count(state, DriveFault::alive_frozen);
    if (moment.time - state.last_alive >= settings.alive_timeout) trip(state, DriveFault::alive_frozen, moment.time);
  } else {
    state.last_alive = moment.time;
  }
  const bool acknowledged = torque.acknowledge && !state.acknowledge;
  // The rate is judged from answer to answer; from rest, over one period.
  const std::int64_t cycles =
      state.state == DriveState::running ? torque.answered_sequence - state.answered_sequence : 1;
  state.has_command = true;
  state.fresh = true;
  state.refused = DriveFault::none;
  state.silence_seen = false;
  state.torque_sequence = torque.sequence;
  state.answered_sequence = torque.answered_sequence;
  state.alive_counter = torque.alive_counter;
  state.acknowledge = torque.acknowledge;
  state.last_command = moment.time;

  switch (state.state) {
    case DriveState::ready:
    case DriveState::running:
      if (torque.brake) {
        state.state = DriveState::braked;
      } else {
        state.state = torque.enable ? DriveState::running : DriveState::ready;
      }
      break;
    case DriveState::tripped:
      break;  // an acknowledgement is worth nothing before the motors stand still
    case DriveState::braked:
      if (state.trip_cause != DriveFault::none) {
        const bool cause_is_gone = moment.main_power && !lost_group(settings, run, moment);
        if (!acknowledged || !cause_is_gone) break;
        state.trip_cause = DriveFault::none;
      }
      if (!torque.brake) state.state = DriveState::ready;
      break;
  }
  if (state.state == DriveState::running) {
    take_torque(settings, run, state, torque, cycles);
  } else {
    state.motor_torque = {};
  }
}

DriveCommand drive_command(const DriveProtectionSettings& settings, const DriveRun& run, DriveProtectionState& state,
                           const DriveMoment& moment, std::int64_t step) {
  if (!moment.main_power) {
    if (!state.power_loss_seen) count(state, DriveFault::power_lost);
    trip(state, DriveFault::power_lost, moment.time);
  }
  state.power_loss_seen = !moment.main_power;
  for (int group = 0; group < run.group_count; ++group) {
    if (moment.group_lost[group] && !state.group_loss_seen[group]) count(state, DriveFault::group_lost);
    state.group_loss_seen[group] = moment.group_lost[group];
  }
  if (lost_group(settings, run, moment)) trip(state, DriveFault::group_lost, moment.time);
  if (moment.time - state.last_command >= settings.silence_timeout) {
    const bool refused = state.refused != DriveFault::none;
    if (!state.silence_seen && !refused) count(state, DriveFault::silence);
    state.silence_seen = true;
    trip(state, refused ? state.refused : DriveFault::silence, moment.time);
  }

  if (state.state == DriveState::tripped) {
    const bool holding = state.brake.torque >= kBrakeHolds * settings.brake.torque;
    const bool standing =
        std::all_of(moment.shaft_speed.begin(), moment.shaft_speed.begin() + run.group_count,
                    [&](double speed) { return std::abs(speed) <= settings.standstill_speed; });
    if (holding && standing) state.state = DriveState::braked;
  }

  const bool apply = state.state == DriveState::tripped || state.state == DriveState::braked;
  DriveCommand command;
  command.sequence = state.torque_sequence;
  command.enable = state.state == DriveState::running;
  const double braking = brake_torque(settings.brake, state.brake, apply, moment.time, step);
  for (int group = 0; group < run.group_count; ++group) {
    command.motor_torque[group] = moment.group_lost[group] ? 0.0 : state.motor_torque[group];
    command.brake_torque[group] = braking;
  }
  return command;
}

double brake_torque(const BrakeSettings& settings, BrakeState& state, bool apply, std::int64_t time,
                    std::int64_t step) {
  if (apply != state.applied) {
    state.applied = apply;
    state.since = time;
  }
  const std::int64_t delay = apply ? settings.closing_delay : settings.release_delay;
  if (time - state.since >= delay) state.closing = apply;

  const double target = state.closing ? settings.torque : 0.0;
  const double time_constant = state.closing ? settings.closing_time_constant : settings.release_time_constant;
  const double begin = state.torque;
  if (begin == target) return target;
  if (time_constant <= 0.0) {
    state.torque = target;
    return target;
  }
  const double steps = static_cast<double>(step) * kNanosecond / time_constant;
  const double gained = -std::expm1(-steps);  // share of the way covered in this step
  state.torque = begin + (target - begin) * gained;
  if (!state.closing && state.torque < kBrakeOpen * settings.torque) state.torque = 0.0;
  return target + (begin - target) * gained / steps;
}

}  // namespace slewlab::sim
