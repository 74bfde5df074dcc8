#include "sim/drive/fault_injector.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "msgs/codec.h"
#include "sim/effects/random_number.h"

namespace slewlab::sim {
namespace {

// Draws of one message or one period, told apart.
enum Draw : std::uint64_t { kHit = 0, kPlace = 1, kSize = 2, kNoise = 8 };
constexpr std::uint64_t kDraws = 64;  // room for the noise of all groups

std::uint64_t counter(std::int64_t sequence, std::uint64_t draw) {
  return static_cast<std::uint64_t>(sequence) * kDraws + draw;
}

// By Box and Muller, from the two numbers at `draw` and behind it.
double normal_number(std::uint64_t seed, std::int64_t sequence, std::uint64_t draw) {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform_number(seed, counter(sequence, draw))));
  return radius * std::cos(2.0 * std::numbers::pi * uniform_number(seed, counter(sequence, draw + 1)));
}

// A controller of any make may answer with any number.
std::int64_t raised(std::int64_t value, std::uint64_t by) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(value) + by);
}

bool is_message_fault(FaultKind kind) {
  return kind == FaultKind::message_lost || kind == FaultKind::message_delayed ||
         kind == FaultKind::message_duplicated || kind == FaultKind::message_reordered ||
         kind == FaultKind::message_corrupted;
}

}  // namespace

FaultInjector::FaultInjector(std::vector<Fault> faults, std::int64_t controller_period, Stopping stopping)
    : faults_(std::move(faults)),
      controller_period_(controller_period),
      stopping_(stopping),
      actions_done_(faults_.size()),
      frozen_(faults_.size()),
      alive_counter_(faults_.size()) {}

void FaultInjector::add(const Fault& fault) {
  faults_.push_back(fault);
  actions_done_.emplace_back();
  frozen_.emplace_back();
  alive_counter_.emplace_back();
}

void FaultInjector::end(std::size_t number, std::int64_t time) {
  Fault& fault = faults_.at(number);
  fault.until = std::min(fault.until, time);
  for (Side& one : sides_) {
    for (Held& held : one.held) {
      if (held.fault == number) held.due = fault.until;
    }
  }
}

PlantConditions FaultInjector::conditions(std::int64_t time) const {
  PlantConditions conditions;
  for (const Fault& fault : faults_) {
    if (!fault.active(time)) continue;
    if (fault.kind == FaultKind::main_power_lost) conditions.main_power = false;
    if (fault.kind == FaultKind::motor_group_lost) {
      for (int group = 0; group < kMaximumGroupCount; ++group) {
        if (fault.group < 0 || fault.group == group) conditions.group_lost[group] = true;
      }
    }
  }
  return conditions;
}

std::vector<ControllerAction> FaultInjector::controller_actions(std::int64_t time) {
  std::vector<ControllerAction> actions;
  for (std::size_t i = 0; i < faults_.size(); ++i) {
    const Fault& fault = faults_[i];
    const bool killed = fault.kind == FaultKind::controller_killed;
    const bool stopped = fault.kind == FaultKind::controller_stopped && stopping_ == Stopping::process_stopped;
    if (!killed && !stopped) continue;
    if (actions_done_[i] == 0 && time >= fault.from) {
      actions.push_back(killed ? ControllerAction::kill : ControllerAction::stop);
      actions_done_[i] = 1;
    }
    if (actions_done_[i] == 1 && time >= fault.until) {
      actions.push_back(killed ? ControllerAction::start : ControllerAction::resume);
      actions_done_[i] = 2;
    }
  }
  return actions;
}

bool FaultInjector::controller_absent(std::int64_t time) const {
  return std::any_of(faults_.begin(), faults_.end(), [&](const Fault& fault) {
    return fault.kind == FaultKind::controller_killed && fault.active(time);
  });
}

void FaultInjector::alter(std::int64_t time, msgs::Encoder& message) {
  for (std::size_t i = 0; i < faults_.size(); ++i) {
    const Fault& fault = faults_[i];
    if (!fault.active(time)) {
      frozen_[i].held = false;
      continue;
    }
    if (fault.kind == FaultKind::encoder_frozen && !frozen_[i].held) {
      frozen_[i] = {true, message.shaft_speed, message.shaft_position};
    }
    for (std::size_t group = 0; group < message.shaft_speed.size(); ++group) {
      if (fault.group >= 0 && group != static_cast<std::size_t>(fault.group)) continue;
      double& speed = message.shaft_speed[group];
      double& position = message.shaft_position[group];
      switch (fault.kind) {
        case FaultKind::encoder_frozen:
          speed = frozen_[i].speed[group];
          position = frozen_[i].position[group];
          break;
        case FaultKind::encoder_noisy:
          speed += fault.speed * normal_number(fault.seed, message.sequence, kNoise + 4 * group);
          position += fault.position * normal_number(fault.seed, message.sequence, kNoise + 4 * group + 2);
          break;
        case FaultKind::encoder_offset:
          speed += fault.speed;
          position += fault.position;
          break;
        case FaultKind::encoder_dropped:
          speed = position = std::numeric_limits<double>::quiet_NaN();
          break;
        default: break;
      }
    }
  }
}

void FaultInjector::begin_period(FaultChannel channel, std::int64_t time) {
  Side& here = side(channel);
  here.arriving.clear();
  here.time = time;
  here.is_heard = channel != FaultChannel::encoder || !controller_absent(time);
  release(here, false);
}

void FaultInjector::end_period(FaultChannel channel) { release(side(channel), true); }

// What was held back for a controller that is no more is lost.
void FaultInjector::release(Side& here, bool behind) {
  for (Held& held : here.held) {
    if (held.due <= here.time && held.behind == behind && here.is_heard) here.arriving.push_back(std::move(held.message));
  }
  std::erase_if(here.held, [&](const Held& held) { return held.due <= here.time && held.behind == behind; });
}

void FaultInjector::pass(FaultChannel channel, std::int64_t time, std::int64_t sequence,
                         std::span<const std::uint8_t> bytes) {
  Side& here = side(channel);
  Message message{sequence, {bytes.begin(), bytes.end()}};
  for (std::size_t i = 0; i < faults_.size(); ++i) {
    const Fault& fault = faults_[i];
    if (!fault.active(time)) {
      alive_counter_[i].reset();
      continue;
    }
    if (fault.kind == FaultKind::controller_stopped && stopping_ == Stopping::questions_held &&
        channel == FaultChannel::encoder) {
      here.held.push_back({fault.until, false, std::move(message), i});
      return;
    }
    if (!is_message_fault(fault.kind) || fault.channel != channel) continue;
    if (uniform_number(fault.seed, counter(sequence, kHit)) >= fault.probability) continue;
    switch (fault.kind) {
      case FaultKind::message_delayed:
        here.held.push_back({time + fault.cycles * controller_period_, false, std::move(message)});
        return;
      case FaultKind::message_reordered:
        here.held.push_back({time + controller_period_, true, std::move(message)});
        return;
      case FaultKind::message_duplicated:
        here.arriving.push_back(message);
        here.arriving.push_back(std::move(message));
        return;
      case FaultKind::message_corrupted:
        corrupt(i, static_cast<std::uint64_t>(sequence), message);
        here.arriving.push_back(std::move(message));
        return;
      default: return;  // lost
    }
  }
  here.arriving.push_back(std::move(message));
}

// A message without the bytes or the torques that a corruption would change stays as it is.
void FaultInjector::corrupt(std::size_t index, std::uint64_t draw, Message& message) {
  const Fault& fault = faults_[index];
  std::vector<std::uint8_t>& bytes = message.bytes;
  if (bytes.empty()) return;
  const auto place = [&](std::size_t places) {
    return static_cast<std::size_t>(uniform_number(fault.seed, draw * kDraws + kPlace) * static_cast<double>(places));
  };
  switch (fault.corruption) {
    case Corruption::bits: {
      const std::size_t bit = place(8 * bytes.size());
      bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ (1U << (bit % 8)));
      return;
    }
    case Corruption::truncated: bytes.resize(place(bytes.size())); return;
    case Corruption::garbage:
      // No fingerprint of ours and no plausible head either.
      std::fill(bytes.begin(), bytes.end(), static_cast<std::uint8_t>(0x80 + place(0x7F)));
      return;
    case Corruption::other_version: bytes[0] = static_cast<std::uint8_t>(~bytes[0]); return;
    default: break;
  }
  msgs::Torque torque;
  if (fault.channel != FaultChannel::torque || msgs::decode(bytes, torque) != msgs::DecodeStatus::ok) return;
  const auto set_first_torque = [&](double value) {
    if (!torque.motor_torque.empty()) torque.motor_torque.front() = value;
  };
  switch (fault.corruption) {
    case Corruption::other_configuration: torque.configuration_hash = raised(torque.configuration_hash, 1); break;
    case Corruption::wrong_sequence: torque.answered_sequence = raised(torque.answered_sequence, 1000); break;
    case Corruption::group_count:
      ++torque.group_count;
      torque.motor_torque.push_back(0.0);
      break;
    case Corruption::not_a_number: set_first_torque(std::numeric_limits<double>::quiet_NaN()); break;
    case Corruption::infinite: set_first_torque(std::numeric_limits<double>::infinity()); break;
    case Corruption::torque_limit: set_first_torque(fault.torque); break;
    case Corruption::alive_frozen:
      if (!alive_counter_[index]) alive_counter_[index] = torque.alive_counter;
      torque.alive_counter = *alive_counter_[index];
      break;
    default: break;
  }
  msgs::encode(torque, bytes);
}

}  // namespace slewlab::sim
