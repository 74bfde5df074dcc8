#include "tools/soak/invariants.h"

#include <fmt/format.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>

namespace slewlab::tools {
namespace {

constexpr double kRounding = 1e-9;            // [-] relative, between two ways to compute the same double
constexpr double kPlaceOfContact = 2e-8;      // of a step's turn at top speed, to which the change of contact is found inside it
constexpr double kCancellation = 1e-12;       // [-] of motor and house angle, in their difference
constexpr double kEnergyFloor = 1e-8;         // of the axis's energy at top speed, where next to nothing has been turned over yet
constexpr double kStickingSpeed = 2e-8;       // of the top speed: the brake's solve has converged this far

bool all_finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

double seconds(std::int64_t nanoseconds) { return static_cast<double>(nanoseconds) / 1e9; }

// [rad/s] that a controller can add while it is lied to: the torque limit of all motors on what turns with the axis, for as long as the
// lies last; twice, for what swings back. A load on the rope makes it less.
double speed_by_untrue_encoders(const SoakFacts& facts, std::int64_t now) {
  double told = 0.0;  // [s]
  for (const SoakFacts::Untrue& untrue : facts.untrue_encoders) told += seconds(std::max(std::int64_t{0}, std::min(now, untrue.until) - untrue.from));
  if (told == 0.0) return 0.0;
  const double inertia = 2.0 * facts.axis_energy / (facts.top_speed * facts.top_speed);
  return 2.0 * facts.protection.torque_limit * facts.motors_per_group * facts.group_count * facts.ratio / inertia * told;
}

}  // namespace

void Findings::add(Invariant invariant, std::int64_t time, std::string_view what) {
  for (Violation& known : violations_) {
    if (known.invariant != invariant) continue;
    ++known.count;
    return;
  }
  violations_.push_back({invariant, time, 1, std::string(what)});
}

void take_faults(const std::vector<sim::Fault>& faults, SoakFacts& facts) {
  for (const sim::Fault& fault : faults) {
    const bool on_encoder = fault.channel == sim::FaultChannel::encoder;
    facts.faults = true;
    switch (fault.kind) {
      case sim::FaultKind::controller_killed:
        facts.controller_restarts = true;
        facts.torque_altered = true;
        break;
      case sim::FaultKind::message_corrupted:
        if (on_encoder) {
          facts.encoder_corrupted = facts.encoder_untrue = true;
          facts.untrue_encoders.push_back({fault.from, fault.until});
        }
        facts.torque_altered = true;
        break;
      case sim::FaultKind::controller_stopped:
      case sim::FaultKind::message_lost:
      case sim::FaultKind::message_delayed:
      case sim::FaultKind::message_duplicated:
      case sim::FaultKind::message_reordered:
        facts.torque_altered = true;
        break;
      case sim::FaultKind::encoder_dropped:
        facts.encoder_unusable = true;
        break;
      case sim::FaultKind::encoder_frozen:
      case sim::FaultKind::encoder_noisy:
      case sim::FaultKind::encoder_offset:
        facts.encoder_untrue = true;
        facts.untrue_encoders.push_back({fault.from, fault.until});
        break;
      case sim::FaultKind::motor_group_lost:
      case sim::FaultKind::main_power_lost:
        break;
    }
  }
}

void check_finite(const SoakFacts& facts, const StepRecord& record, Findings& findings) {
  double sum = record.state_sum + record.house_angle + record.house_speed + record.rope_angle + record.rod_angle +
               record.mechanical_energy + record.supplied_work + record.dissipated_power + record.brake_torque;
  for (int i = 0; i < facts.group_count; ++i) {
    sum += record.motor_angle[i] + record.motor_speed[i] + record.gear_torque[i] + record.motor_friction[i] +
           record.applied_torque[i] + record.commanded_torque[i];
  }
  if (std::isfinite(sum)) return;
  findings.add(Invariant::finite, record.time,
               fmt::format("the plant's state is not finite: house {} rad, {} rad/s, energy {} J, sum of the modes {}",
                           record.house_angle, record.house_speed, record.mechanical_energy, record.state_sum));
}

void check_torque_limit(const SoakFacts& facts, const StepRecord& record, Findings& findings) {
  for (int i = 0; i < facts.group_count; ++i) {
    const double applied = record.applied_torque[i];
    const double limit = facts.protection.torque_limit;
    if (std::fabs(record.commanded_torque[i]) > limit || (facts.bare_actuators && std::fabs(applied) > limit)) {
      findings.add(Invariant::torque_limit, record.time,
                   fmt::format("group {}: {} Nm per motor applied, {} Nm held, more than torque_limit, {} Nm", i, applied,
                               record.commanded_torque[i], limit));
    }
    const bool powered = record.drive_state == sim::DriveState::running && record.conditions.main_power &&
                         !record.conditions.group_lost[i];
    const double due = powered ? record.commanded_torque[i] : 0.0;
    if (facts.bare_actuators && applied != due) {
      findings.add(Invariant::torque_limit, record.time,
                   fmt::format("group {}: {} Nm per motor applied, {} Nm due (drive {}, {} Nm held)", i, applied, due,
                               sim::name_of(record.drive_state), record.commanded_torque[i]));
    }
  }
  if (record.brake_torque < 0.0 || record.brake_torque > facts.protection.brake.torque) {
    findings.add(Invariant::torque_limit, record.time,
                 fmt::format("the brakes' torque is {} Nm per motor, outside 0 to {} Nm", record.brake_torque,
                             facts.protection.brake.torque));
  }
}

void check_torque_rate(const SoakFacts& facts, const StepRecord& before, const StepRecord& record, Findings& findings) {
  if (record.drive_state != sim::DriveState::running) return;
  // From answer to answer; from rest over one period (docs/drive.md).
  const bool was_running = before.drive_state == sim::DriveState::running;
  const std::int64_t cycles = was_running ? record.answered_sequence - before.answered_sequence : 1;
  const double allowed =
      facts.protection.torque_rate_limit * seconds(cycles * facts.controller_period) * (1.0 + kRounding);
  for (int i = 0; i < facts.group_count; ++i) {
    const double from = was_running ? before.commanded_torque[i] : 0.0;
    const double change = std::fabs(record.commanded_torque[i] - from);
    if (change <= allowed || !std::isfinite(facts.protection.torque_rate_limit)) continue;
    findings.add(Invariant::torque_rate, record.time,
                 fmt::format("group {}: torque changed by {} Nm per motor within {} periods, more than {} Nm", i, change,
                             cycles, allowed));
  }
}

void check_speed(const SoakFacts& facts, const SoakLimits& limits, const StepRecord& record, Findings& findings) {
  const double allowed = limits.house_speed + speed_by_untrue_encoders(facts, record.time);
  if (std::fabs(record.house_speed) <= allowed) return;
  findings.add(Invariant::speed_limit, record.time, fmt::format("the house turns at {} rad/s, more than {} rad/s", record.house_speed, allowed));
}

void check_angles(const SoakFacts& facts, const SoakLimits& limits, const StepRecord& record, Findings& findings) {
  if (facts.faults) return;  // the operator foresaw a crane that does as it is told
  if (std::fabs(record.rope_angle) > limits.sidelead) {
    findings.add(Invariant::angle_limit, record.time,
                 fmt::format("sidelead of {} rad, more than {} rad", record.rope_angle, limits.sidelead));
  }
  if (std::fabs(record.rod_angle) > limits.rod_angle) {
    findings.add(Invariant::angle_limit, record.time,
                 fmt::format("the rod hangs at {} rad, more than {} rad", record.rod_angle, limits.rod_angle));
  }
}

void check_contact(const SoakFacts& facts, const StepRecord& before, const StepRecord& record, Findings& findings) {
  for (int i = 0; i < facts.group_count; ++i) {
    const sim::GearContact& gear = facts.gear[i];
    const double deflection = record.motor_angle[i] - record.house_angle;
    const double rate = record.motor_speed[i] - record.house_speed;
    const double torque = record.gear_torque[i];
    const double law = sim::contact_torque(gear, deflection, rate);
    const double depth = std::fabs(deflection) - gear.half_play;
    // Both by the same doubles: they differ by the cancellation in motor minus house angle.
    const double cancellation = std::fabs(record.motor_angle[i]) + std::fabs(record.house_angle);
    const double speeds = std::fabs(record.motor_speed[i]) + std::fabs(record.house_speed);
    const double rounding =
        kRounding * (std::fabs(torque) + gear.stiffness * (gear.half_play + 1e-3 * cancellation) + gear.damping * speeds);
    // Where the flanks have just met or parted, the law jumps by the damping's share.
    const double place = kPlaceOfContact * facts.top_speed * facts.step + kCancellation * cancellation;
    const double tie = std::fabs(depth) < place ? gear.damping * std::fabs(rate) : 0.0;
    if (!(std::fabs(torque - law) <= rounding + tie)) {
      findings.add(Invariant::contact_law, record.time,
                   fmt::format("group {}: gear torque {} Nm, the law gives {} Nm at a deflection of {} rad, {} rad/s (half "
                               "play {} rad)",
                               i, torque, law, deflection, rate, gear.half_play));
    }
    if (torque * record.contact[i] < -rounding || (record.contact[i] == 0 && torque != 0.0)) {
      findings.add(Invariant::contact_law, record.time,
                   fmt::format("group {}: teeth pull: {} Nm on flank {} at a deflection of {} rad", i, torque,
                               record.contact[i], deflection));
    }
    if (depth < -place && std::fabs(torque) > rounding) {
      findings.add(Invariant::contact_law, record.time,
                   fmt::format("group {}: {} Nm inside the play, at a deflection of {} rad of {} rad", i, torque,
                               deflection, gear.half_play));
    }
    if (record.play_crossings[i] < before.play_crossings[i]) {
      findings.add(Invariant::contact_law, record.time,
                   fmt::format("group {}: the count of play crossings fell from {} to {}", i, before.play_crossings[i],
                               record.play_crossings[i]));
    }
  }
  if (record.unsplit_steps != before.unsplit_steps) {
    findings.add(Invariant::contact_law, record.time, "more contact changes inside one step than it can be split at");
  }
}

void check_friction(const SoakFacts& facts, const StepRecord& before, const StepRecord& record, Findings& findings) {
  if (record.unsolved_frictions != before.unsolved_frictions) {
    findings.add(Invariant::friction_law, record.time, "frictions of motors and house that do not keep to their law were taken");
  }
  if (!facts.bare_brakes) return;
  const double capacity = facts.protection.brake.torque * facts.motors_per_group * facts.ratio;
  for (int i = 0; i < facts.group_count; ++i) {
    const double friction = record.motor_friction[i];
    const double power = friction * record.motor_speed[i];
    if (std::fabs(friction) > capacity * (1.0 + kRounding)) {
      findings.add(Invariant::friction_law, record.time,
                   fmt::format("group {}: the brakes act with {} Nm, more than their {} Nm", i, friction, capacity));
    }
    if (power > std::fabs(friction) * kStickingSpeed * facts.top_speed) {
      findings.add(Invariant::friction_law, record.time,
                   fmt::format("group {}: the brakes drive the motors: {} Nm at {} rad/s", i, friction,
                               record.motor_speed[i]));
    }
  }
}

void check_drive(const SoakFacts& facts, const StepRecord& before, const StepRecord& record, bool by_message,
                 Findings& findings) {
  using sim::DriveFault;
  using sim::DriveState;
  const DriveState from = before.drive_state;
  const DriveState to = record.drive_state;
  const bool latched = record.trip_cause != DriveFault::none;
  bool legal = from == to;
  if (from != to) {
    switch (to) {
      case DriveState::tripped: legal = latched; break;
      case DriveState::running: legal = by_message && from == DriveState::ready; break;
      case DriveState::ready: legal = by_message && (from == DriveState::running || from == DriveState::braked); break;
      case DriveState::braked: legal = (by_message && from != DriveState::tripped) || (!by_message && latched); break;
    }
  }
  if (!legal) {
    findings.add(Invariant::drive_state, record.time,
                 fmt::format("the drive went from {} to {} at {} (trip cause {})", sim::name_of(from), sim::name_of(to),
                             by_message ? "a message" : "a step", sim::name_of(record.trip_cause)));
  }
  const bool wants_cause = to == DriveState::tripped;
  const bool bars_cause = to == DriveState::ready || to == DriveState::running;
  if ((wants_cause && !latched) || (bars_cause && latched)) {
    findings.add(Invariant::drive_state, record.time,
                 fmt::format("the drive is {} with trip cause {}", sim::name_of(to), sim::name_of(record.trip_cause)));
  }
  const auto& lost = record.conditions.group_lost;
  const bool group_trips = facts.protection.trip_on_group_lost &&
                           std::any_of(lost.begin(), lost.begin() + facts.group_count, [](bool one) { return one; });
  if (!by_message && (!record.conditions.main_power || group_trips) && to != DriveState::tripped &&
      to != DriveState::braked) {
    findings.add(Invariant::drive_state, record.time,
                 fmt::format("the drive is {} although {} is lost", sim::name_of(to),
                             record.conditions.main_power ? "a motor group" : "the main power"));
  }
}

EnergyBalance::EnergyBalance(const SoakFacts& facts, const SoakLimits& limits, const StepRecord& first)
    : facts_(facts),
      limit_(limits.energy_error),
      first_energy_(first.mechanical_energy),
      first_work_(first.supplied_work),
      before_(first),
      turned_over_(first.mechanical_energy + kEnergyFloor * facts.axis_energy) {}

void EnergyBalance::check(const StepRecord& record, Findings& findings) {
  const double lost = 0.5 * facts_.step * (before_.dissipated_power + record.dissipated_power) +
                      record.dissipated_by_modes - before_.dissipated_by_modes;
  dissipated_ += lost;
  turned_over_ += std::fabs(record.supplied_work - before_.supplied_work) + lost;
  if (record.contact_changes != before_.contact_changes) {
    for (int i = 0; i < facts_.group_count; ++i) {
      const double rate_before = before_.motor_speed[i] - before_.house_speed;
      const double rate = record.motor_speed[i] - record.house_speed;
      unseen_ += facts_.step * facts_.gear[i].damping * std::max(rate_before * rate_before, rate * rate);
    }
  }
  before_ = record;
  const double supplied = record.supplied_work - first_work_;
  const double error = record.mechanical_energy - first_energy_ - supplied + dissipated_;
  const double share = std::max(0.0, std::fabs(error) - unseen_) / turned_over_;
  largest_error_ = std::max(largest_error_, share);
  if (share <= limit_) return;
  findings.add(Invariant::energy_balance, record.time,
               fmt::format("energy {} J, at the start {} J, supplied {} J, dissipated {} J (of impacts inside a step {} J "
                           "are not seen): {} J too much, {} % of what was turned over beyond that, more than {} %",
                           record.mechanical_energy, first_energy_, supplied, dissipated_, unseen_, error, 100.0 * share,
                           100.0 * limit_));
}

template <class Message>
bool MessageInvariants::take_head(const Message& message, const char* channel, Row& row, Findings& findings) {
  const std::int64_t time = stamp_us_ * 1000;
  if (message.sequence != row.next) {
    findings.add(Invariant::sequence, time,
                 fmt::format("{} number {} follows number {}", channel, message.sequence, row.next - 1));
  }
  row.next = message.sequence + 1;
  if (message.configuration_hash != facts_.configuration_hash) {
    findings.add(Invariant::sequence, time, fmt::format("{} number {} belongs to another configuration", channel,
                                                        message.sequence));
  }
  return true;
}

void MessageInvariants::look(std::string_view channel, std::int64_t timestamp_us, msgs::Bytes bytes,
                             Findings& findings) {
  if (timestamp_us < stamp_us_) {
    findings.add(Invariant::clock, stamp_us_ * 1000,
                 fmt::format("an event of {} is stamped {} us, before the last one's {} us", channel, timestamp_us,
                             stamp_us_));
  }
  stamp_us_ = timestamp_us;
  const std::int64_t time = stamp_us_ * 1000;
  const auto readable = [&](msgs::DecodeStatus status) {
    if (status == msgs::DecodeStatus::ok) return true;
    findings.add(Invariant::sequence, time, fmt::format("a message on {} is {}", channel, msgs::to_string(status)));
    return false;
  };
  // Simulated time follows from the number alone: no drift, no gap.
  const auto check_clock = [&](const auto& message, std::int64_t period) {
    if (message.simulated_time == message.sequence * period && message.simulated_time / 1000 == stamp_us_) return;
    findings.add(Invariant::clock, time,
                 fmt::format("{} number {} speaks of {} ns, stamped {} us; {} ns is due", channel, message.sequence,
                             message.simulated_time, stamp_us_, message.sequence * period));
  };
  const auto check_numbers = [&](bool finite) {
    if (!finite) findings.add(Invariant::finite, time, fmt::format("{} holds a number that is not finite", channel));
  };

  if (channel == msgs::kEncoderChannel) {
    if (!readable(msgs::decode(bytes, encoder_))) return;
    take_head(encoder_, "ENCODER", encoder_row_, findings);
    check_clock(encoder_, facts_.controller_period);
    check_numbers(facts_.encoder_unusable ||
                  (all_finite(encoder_.shaft_speed) && all_finite(encoder_.shaft_position)));
  } else if (channel == msgs::kOperatorChannel) {
    if (!readable(msgs::decode(bytes, operator_))) return;
    take_head(operator_, "OPERATOR", operator_row_, findings);
    check_numbers(std::isfinite(operator_.speed_request));
  } else if (channel == msgs::kTorqueChannel) {
    const msgs::DecodeStatus status = msgs::decode(bytes, torque_);
    if (!facts_.torque_altered && !readable(status)) return;
    look_at(torque_, status, findings);
  } else if (channel == msgs::kControllerStateChannel) {
    if (readable(msgs::decode(bytes, state_))) look_at(state_, findings);
  } else if (channel == msgs::kSensorsChannel) {
    if (!readable(msgs::decode(bytes, sensors_))) return;
    take_head(sensors_, "SENSORS", sensors_row_, findings);
    check_clock(sensors_, facts_.sensors_period);
    const auto& fields = msgs::kSensorFields<msgs::Sensors>;
    check_numbers(std::all_of(fields.begin(), fields.end(), [&](const auto& field) { return std::isfinite(sensors_.*field.value); }));
  } else if (channel == msgs::kTruthChannel) {
    if (!readable(msgs::decode(bytes, truth_))) return;
    take_head(truth_, "TRUTH", truth_row_, findings);
    check_clock(truth_, facts_.truth_period);
    check_numbers(std::isfinite(truth_.house_speed + truth_.tip_displacement + truth_.tip_velocity + truth_.rope_angle +
                                truth_.rod_angle + truth_.mechanical_energy + truth_.supplied_work) &&
                  all_finite(truth_.gearbox_torque) && all_finite(truth_.gear_deflection) &&
                  all_finite(truth_.shear_force) && all_finite(truth_.modal_energy));
  } else if (channel == msgs::kPlantStatusChannel) {
    if (!readable(msgs::decode(bytes, status_))) return;
    take_head(status_, "PLANT_STATUS", status_row_, findings);
    check_clock(status_, facts_.status_period);
    look_at(status_, findings);
  }
}

void MessageInvariants::look_at(const msgs::Torque& torque, msgs::DecodeStatus status, Findings& findings) {
  // What the drive got while messages are altered on purpose is for the drive to judge, not for us.
  if (facts_.torque_altered || status != msgs::DecodeStatus::ok) return;
  const std::int64_t time = stamp_us_ * 1000;
  take_head(torque, "TORQUE", torque_row_, findings);
  if (torque.answered_sequence != encoder_.sequence || torque.simulated_time != encoder_.simulated_time) {
    findings.add(Invariant::sequence, time,
                 fmt::format("TORQUE number {} answers ENCODER {} of {} ns, asked was {} of {} ns", torque.sequence,
                             torque.answered_sequence, torque.simulated_time, encoder_.sequence,
                             encoder_.simulated_time));
  }
  if (alive_counter_ >= 0 && torque.alive_counter != alive_counter_ + 1) {
    findings.add(Invariant::sequence, time, fmt::format("the alive counter went from {} to {}", alive_counter_,
                                                        torque.alive_counter));
  }
  alive_counter_ = torque.alive_counter;
  if (torque.group_count != facts_.group_count) {
    findings.add(Invariant::untroubled, time, fmt::format("TORQUE has {} groups, the crane {}", torque.group_count,
                                                          facts_.group_count));
  }
  if (!all_finite(torque.motor_torque)) {
    findings.add(Invariant::finite, time, "TORQUE holds a number that is not finite");
  }
}

void MessageInvariants::look_at(const msgs::ControllerState& state, Findings& findings) {
  const std::int64_t time = stamp_us_ * 1000;
  if (facts_.controller_restarts && state.sequence == 0) state_row_.next = 0;
  take_head(state, "CONTROLLER_STATE", state_row_, findings);
  if (state.answered_sequence <= answered_by_state_) {
    findings.add(Invariant::sequence, time, fmt::format("CONTROLLER_STATE answers ENCODER {} after {}",
                                                        state.answered_sequence, answered_by_state_));
  }
  answered_by_state_ = state.answered_sequence;
  if (!facts_.encoder_corrupted && state.simulated_time != state.answered_sequence * facts_.controller_period) {
    findings.add(Invariant::clock, time, fmt::format("CONTROLLER_STATE speaks of {} ns and answers ENCODER {}",
                                                     state.simulated_time, state.answered_sequence));
  }
  if (!std::isfinite(state.ramped_speed + state.average_torque + state.offset_torque) ||
      !all_finite(state.proportional_torque) || !all_finite(state.integral_torque)) {
    findings.add(Invariant::finite, time, "CONTROLLER_STATE holds a number that is not finite");
  }
}

void MessageInvariants::look_at(const msgs::PlantStatus& status, Findings& findings) {
  const std::int64_t time = stamp_us_ * 1000;
  for (std::size_t i = 0; i < status.faults.size(); ++i) {
    const std::int64_t before = i < last_status_.faults.size() ? last_status_.faults[i] : 0;
    if (status.faults[i] < before) {
      findings.add(Invariant::sequence, time, fmt::format("the count of {} fell from {} to {}", sim::kDriveFaultNames.at(i),
                                                          before, status.faults[i]));
    }
    if (!facts_.faults && status.faults[i] != 0) {
      findings.add(Invariant::untroubled, time,
                   fmt::format("the drive saw {} {} times without a fault on purpose", sim::kDriveFaultNames.at(i),
                               status.faults[i]));
    }
  }
  if (status.stale_commands < last_status_.stale_commands) {
    findings.add(Invariant::sequence, time, "the count of stale commands fell");
  }
  if (!facts_.faults && (status.stale_commands != 0 || status.trip_cause != 0)) {
    findings.add(Invariant::untroubled, time,
                 fmt::format("{} stale commands, drive {}, trip cause {}, without a fault on purpose",
                             status.stale_commands, sim::kDriveStateNames.at(static_cast<std::size_t>(status.drive_state)),
                             sim::kDriveFaultNames.at(static_cast<std::size_t>(status.trip_cause))));
  }
  if (status.missed_deadlines != 0 || status.bin_count != 0) {
    findings.add(Invariant::clock, time, "the wall clock shows in PLANT_STATUS of a run in lockstep");
  }
  last_status_ = status;
}

MemoryUse memory_use() {
#ifdef SLEWLAB_SANITIZED
  return {};  // the sanitizers keep what is freed
#endif
  constexpr std::int64_t kKilobyte = 1024;
  MemoryUse use;
  const struct mallinfo2 heap = mallinfo2();
  use.heap = static_cast<std::int64_t>(heap.uordblks + heap.hblkhd) / kKilobyte;
  std::int64_t size = 0, resident = 0;
  if (std::ifstream("/proc/self/statm") >> size >> resident) use.resident = resident * (::sysconf(_SC_PAGESIZE) / kKilobyte);
  return use;
}

void check_memory(const SoakLimits& limits, const MemoryUse& before, const MemoryUse& now, std::string_view what,
                  std::int64_t time, Findings& findings) {
  if (now.heap - before.heap > limits.heap_growth) {
    findings.add(Invariant::memory, time,
                 fmt::format("{} kB allocated, {} kB {}: grown by more than {} kB", now.heap, before.heap, what,
                             limits.heap_growth));
  }
  if (now.resident - before.resident > limits.resident_growth) {
    findings.add(Invariant::memory, time,
                 fmt::format("{} kB resident, {} kB {}: grown by more than {} kB", now.resident, before.resident, what,
                             limits.resident_growth));
  }
}

}  // namespace slewlab::tools
