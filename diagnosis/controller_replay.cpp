#include "diagnosis/controller_replay.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "controller/process/computed_answer.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kRampTimes = 1.5;  // of the slowest change from one top speed to the other and a half, after which no ramp is under way
// After which a filter, and the integrals' first values, have forgotten what they began with: times of the filter, and cycles.
constexpr double kFilterTimes = 7.0, kFirstCycles = 3.0;
// Of the rated torque: a controller that was switched on with the recorder answers its first reading as exactly.
constexpr double kFreshly = 1e-6;
constexpr double kTakeUpCycles = 10.0;  // before the controller is known: the integrals of each cycle follow from its own answer, whatever they were before
constexpr int kTakeUpSteps = 20;    // of the integrals: after each an error remains, what the droop and the filter couple, a small share
// Of the rated torque: below it a taken-up integral is exact.
constexpr double kTakenUpExactly = 1e-12;

// A ramp under way shows in the speed: from one such share of the longest ramp to the next the mean speed changes by more than this share of the top speed.
// A change of the request that is too small for that has a ramp that is shorter than the share.
constexpr double kSteadyShare = 0.25, kSteadySpeed = 0.005;

double settling_time(const controller::RampSettings& ramp) {
  return kRampTimes * std::max(ramp.acceleration_time + ramp.deceleration_time, ramp.emergency_stop_time);
}

// [rad/s] Mean of all groups' measured speeds over a time [s]; nothing where no reading lies in it.
std::optional<double> mean_speed(const Record& record, double from, double to) {
  const auto time_of = [](const msgs::Encoder& encoder) { return 1e-9 * static_cast<double>(encoder.simulated_time); };
  const auto first = std::partition_point(record.encoder.begin(), record.encoder.end(), [&](const msgs::Encoder& one) { return time_of(one) < from; });
  double sum = 0.0;
  std::size_t count = 0;
  for (auto one = first; one != record.encoder.end() && time_of(*one) < to; ++one) {
    for (int g = 0; g < record.group_count; ++g, ++count) sum += one->shaft_speed[static_cast<std::size_t>(g)];
  }
  if (count == 0) return {};
  return sum / static_cast<double>(count);
}

// [s] When no ramp is under way any more, the joystick standing still from one moment to another [s]: where it does so for longer than any ramp takes, or sooner,
// where the speed has ceased to change. The first share of the longest ramp is left to one that is only beginning, the last one to the end of its curve.
std::optional<double> ramp_ended(const Record& record, const controller::ControllerSettings& settings, double still_from, double until) {
  const double settled = still_from + settling_time(settings.ramp);
  const double share = kSteadyShare * std::max({settings.ramp.acceleration_time, settings.ramp.deceleration_time, settings.ramp.emergency_stop_time});
  const double least = kSteadySpeed * settings.ramp.top_speed * settings.total_ratio;
  double from = still_from + share;
  while (share > 0.0 && from + 2.0 * share < std::min(until, settled)) {
    const std::optional<double> before = mean_speed(record, from, from + 0.5 * share), after = mean_speed(record, from + 0.5 * share, from + share);
    if (before && after && std::fabs(*after - *before) < least) return from + 2.0 * share;
    from += 0.25 * share;
  }
  if (until >= settled) return settled;
  return {};
}

// The integrals with which the controller answers this cycle as it was recorded, all else being known. How fast a command may change has no part in it: what was
// commanded before is not the replay's.
void take_up_integrals(controller::ControllerSettings settings, const controller::ControllerInput& input, const msgs::Torque& recorded,
                       controller::ControllerState& state) {
  settings.limits.rate = std::numeric_limits<double>::infinity();
  controller::ControllerOutput output;
  for (int step = 0; step < kTakeUpSteps; ++step) {
    controller::ControllerState trial = state;
    controller::step(settings, trial, input, output);
    double mean = 0.0, largest = 0.0;
    controller::PerGroup missing{};
    for (int g = 0; g < settings.group_count; ++g) {
      const auto i = static_cast<std::size_t>(g);
      missing[i] = recorded.motor_torque[i] - output.motor_torque[i];
      mean += missing[i] / settings.group_count;
      largest = std::max(largest, std::fabs(missing[i]));
    }
    // With play compensation the groups share one integral.
    const double left = settings.play_compensation.enabled ? std::fabs(mean) : largest;
    if (left < kTakenUpExactly * settings.rated_torque) return;
    for (int g = 0; g < settings.group_count; ++g) {
      const auto i = static_cast<std::size_t>(g);
      state.speed_control[i].integral_torque += settings.play_compensation.enabled ? mean : missing[i];
    }
  }
}

// Whether a command is limited, in size or in its change since the one before: then it does not tell the integrals behind it.
bool is_limited(const controller::ControllerSettings& settings, const msgs::Torque& before, const msgs::Torque& torque, double period) {
  const auto reaches = [](double value, double limit) { return std::fabs(value) >= (1.0 - kFreshly) * limit; };
  for (std::size_t g = 0; g < torque.motor_torque.size(); ++g) {
    if (reaches(torque.motor_torque[g], settings.limits.torque)) return true;
    if (reaches(torque.motor_torque[g] - before.motor_torque[g], settings.limits.rate * period)) return true;
  }
  return false;
}

// [s] The first moment from `from` on before which a command tells the integrals; nothing where there is none.
std::optional<double> integrals_known_from(const Record& record, const controller::ControllerSettings& settings, double from) {
  for (std::size_t n = 1; n < record.torque.size(); ++n) {
    const double next = 1e-9 * static_cast<double>(record.torque[n].simulated_time) + record.encoder_period;
    if (next >= from && !is_limited(settings, record.torque[n - 1], record.torque[n], record.encoder_period)) return next;
  }
  return {};
}

// Whether the record's first command is what the controller answers when it has just been switched on.
bool is_fresh(const Record& record, controller::ControllerSettings settings) {
  settings.period = record.encoder_period;
  const msgs::Encoder& encoder = record.encoder.front();
  const auto answer = std::find_if(record.torque.begin(), record.torque.end(),
                                   [&](const msgs::Torque& torque) { return torque.answered_sequence >= encoder.sequence; });
  if (answer == record.torque.end() || answer->answered_sequence != encoder.sequence) return true;
  controller::ControllerState state;
  controller::ControllerInput input;
  controller::ControllerOutput output;
  input.simulated_time = encoder.simulated_time;
  input.group_count = record.group_count;
  std::copy_n(encoder.shaft_speed.begin(), record.group_count, input.shaft_speed.begin());
  if (!record.operator_moves.empty() && record.operator_moves.front().simulated_time <= encoder.simulated_time) {
    input.speed_request = record.operator_moves.front().speed_request;
  }
  controller::step(settings, state, input, output);
  for (std::size_t g = 0; g < static_cast<std::size_t>(record.group_count); ++g) {
    if (std::fabs(answer->motor_torque[g] - output.motor_torque[g]) > kFreshly * settings.rated_torque) return false;
  }
  return true;
}

}  // namespace

void check_replayable(const Record& record) {
  const bool is_asked = record.begins_in_motion || std::any_of(record.operator_moves.begin(), record.operator_moves.end(),
                                                               [](const OperatorMove& move) { return move.speed_request != 0.0; });
  if (is_asked && !record.operator_moves.empty()) return;
  double largest = 0.0;
  for (const double rate : record.position_rate[0]) largest = std::max(largest, std::fabs(rate));
  throw NotAdmitted(fmt::format("{}: the motors reach {:.3g} rad/s and no OPERATOR message asks for it; without the operator's moves the controller cannot be "
                                "replayed. Log them (an import maps speed_request), or leave --controller out: the crane is then diagnosed alone",
                                record.name, largest));
}

std::optional<double> controller_known_from(const Record& record, const controller::ControllerSettings& settings) {
  if (!record.begins_bent) {
    if (is_fresh(record, settings)) return record.start_time;
    return integrals_known_from(record, settings, record.start_time + kFilterTimes * settings.speed_filter_time + kFirstCycles * record.encoder_period);
  }
  double still_from = record.start_time;
  const OperatorMove* before = nullptr;
  for (const OperatorMove& move : record.operator_moves) {
    const bool is_change = before == nullptr || move.speed_request != before->speed_request || move.emergency_stop != before->emergency_stop;
    before = &move;
    if (!is_change) continue;
    const double at = 1e-9 * static_cast<double>(move.simulated_time);
    if (const std::optional<double> ended = ramp_ended(record, settings, still_from, at)) return integrals_known_from(record, settings, *ended);
    still_from = std::max(record.start_time, at);
  }
  const std::optional<double> ended = ramp_ended(record, settings, still_from, record.time(record.size() - 1));
  if (!ended) return {};
  return integrals_known_from(record, settings, *ended);
}

ControllerReplay replay_controller(const Record& record, const controller::ControllerSettings& settings) {
  return replay_controller(record, settings, controller_known_from(record, settings));
}

ControllerReplay replay_controller(const Record& record, controller::ControllerSettings settings, std::optional<double> known_from, const GiveUp& give_up) {
  if (settings.group_count != record.group_count) {
    throw NotAdmitted(fmt::format("{}: the log has {} motor groups, the controller {}", record.name,
                                  record.group_count, settings.group_count));
  }
  settings.period = record.encoder_period;
  ControllerReplay replay;
  if (!known_from) return replay;
  controller::ControllerState state;
  controller::PlausibilityState plausibility;
  controller::ControllerInput input;
  controller::ControllerOutput output;
  input.group_count = record.group_count;
  std::size_t move = 0;
  std::size_t answer = 0;
  double square = 0.0, difference_square = 0.0;
  const auto take_moves = [&](std::int64_t until) {
    for (; move < record.operator_moves.size() && record.operator_moves[move].simulated_time <= until; ++move) {
      input.speed_request = record.operator_moves[move].speed_request;
      input.emergency_stop = record.operator_moves[move].emergency_stop;
      input.acknowledge = record.operator_moves[move].acknowledge;
    }
  };
  const auto period = static_cast<std::int64_t>(std::llround(record.encoder_period * 1e9));
  for (std::size_t e = 0; e < record.encoder.size(); ++e) {
    const msgs::Encoder& encoder = record.encoder[e];
    if (e > 0) {
      const msgs::Encoder& before = record.encoder[e - 1];
      const std::int64_t cycles = (encoder.simulated_time - before.simulated_time + period / 2) / period;
      for (std::int64_t c = 1; c < cycles; ++c) {
        input.simulated_time = before.simulated_time + c * period;
        const double share = static_cast<double>(c) / static_cast<double>(cycles);
        for (std::size_t g = 0; g < static_cast<std::size_t>(record.group_count); ++g) {
          input.shaft_speed[g] = before.shaft_speed[g] + share * (encoder.shaft_speed[g] - before.shaft_speed[g]);
        }
        take_moves(input.simulated_time);
        controller::step(settings, state, input, output);
      }
    }
    take_moves(encoder.simulated_time);
    controller::take_reading(settings, encoder, plausibility, input);
    while (answer < record.torque.size() && record.torque[answer].answered_sequence < encoder.sequence) ++answer;
    const bool answered =
        answer < record.torque.size() && record.torque[answer].answered_sequence == encoder.sequence;
    const double before_known = *known_from - 1e-9 * static_cast<double>(encoder.simulated_time);
    const bool is_known = before_known < 0.5 * record.encoder_period;  // half a cycle: whatever the times are rounded to
    if (!is_known) {
      // As if the ramp had come to its end already: when it is to be known, it has.
      state.ramp = {};
      state.ramp.speed = state.ramp.target = std::clamp(input.speed_request, -1.0, 1.0) * settings.ramp.top_speed;
      if (answered && before_known < kTakeUpCycles * record.encoder_period) take_up_integrals(settings, input, record.torque[answer], state);
    }
    controller::step(settings, state, input, output);
    if (!is_known && answered) std::copy_n(record.torque[answer].motor_torque.begin(), record.group_count, state.commanded_torque.begin());
    for (int g = 0; g < record.group_count; ++g) {
      const auto i = static_cast<std::size_t>(g);
      replay.motor_torque[i].push_back(output.motor_torque[i]);
      if (!answered || !is_known) continue;
      const double recorded = record.torque[answer].motor_torque[i];
      const double difference = recorded - output.motor_torque[i];
      square += recorded * recorded;
      difference_square += difference * difference;
      const std::size_t entry = replay.difference.size();
      replay.difference.push_back(difference);
      if (entry >= give_up.lag) {
        const double change = difference - (give_up.lag > 0 ? replay.difference[entry - give_up.lag] : 0.0);
        replay.change_square += change * change;
      }
      if (std::fabs(difference) > replay.largest_difference) {
        replay.largest_difference = std::fabs(difference);
        replay.largest_time = static_cast<double>(encoder.simulated_time) * 1e-9;
      }
    }
    if (replay.change_square > give_up.above) {
      replay.is_given_up = true;
      return replay;
    }
  }
  if (!replay.difference.empty()) {
    const auto compared = static_cast<double>(replay.difference.size());
    replay.torque_rms = std::sqrt(square / compared);
    replay.difference_rms = std::sqrt(difference_square / compared);
  }
  return replay;
}

}  // namespace slewlab::diagnosis
