#include "diagnosis/controller_replay.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace slewlab::diagnosis {

namespace {

// Speeds that a swinging load may make of a crane at rest: shares of the largest speed of the record, and of the controller's top speed.
constexpr double kStanding = 0.05, kCreeping = 2e-3;
constexpr double kFirstStretch = 0.023;  // of the time from rest to top speed

}  // namespace

void check_replayable(const Record& record, const controller::ControllerSettings& settings) {
  constexpr const char* kRemedy = "or leave --controller out: the crane is then diagnosed alone";
  double largest = 0.0, first = 0.0;
  const auto stretch = std::min(record.size(), static_cast<std::size_t>(kFirstStretch * settings.ramp.acceleration_time / record.step) + 1);
  for (std::size_t n = 0; n < record.size(); ++n) largest = std::max(largest, std::fabs(record.position_rate[0][n]));
  // Of all groups: play compensation turns them against each other first.
  for (int g = 0; g < record.group_count; ++g) {
    for (std::size_t n = 0; n < stretch; ++n) first += record.position_rate[static_cast<std::size_t>(g)][n] / static_cast<double>(stretch) / record.group_count;
  }
  if (std::fabs(first) > std::max(kStanding * largest, kCreeping * settings.ramp.top_speed * settings.total_ratio)) {
    throw NotAdmitted(fmt::format("{}: the motors turn at {:.3g} rad/s when the record begins; what the controller knew by then is not in it. Cut the log where "
                                  "the crane stands, {}",
                                  record.name, first, kRemedy));
  }
  const bool is_asked = std::any_of(record.operator_moves.begin(), record.operator_moves.end(),
                                    [](const OperatorMove& move) { return move.speed_request != 0.0; });
  if (!is_asked) {
    throw NotAdmitted(fmt::format("{}: the motors reach {:.3g} rad/s and no OPERATOR message asks for it; without the operator's moves the controller cannot be "
                                  "replayed. Log them (an import maps speed_request), {}",
                                  record.name, largest, kRemedy));
  }
}

ControllerReplay replay_controller(const Record& record, controller::ControllerSettings settings) {
  if (settings.group_count != record.group_count) {
    throw NotAdmitted(fmt::format("{}: the log has {} motor groups, the controller {}", record.name,
                                  record.group_count, settings.group_count));
  }
  settings.period = record.encoder_period;
  ControllerReplay replay;
  controller::ControllerState state;
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
    input.simulated_time = encoder.simulated_time;
    for (int g = 0; g < record.group_count; ++g) {
      input.shaft_speed[static_cast<std::size_t>(g)] = encoder.shaft_speed[static_cast<std::size_t>(g)];
    }
    controller::step(settings, state, input, output);
    while (answer < record.torque.size() && record.torque[answer].answered_sequence < encoder.sequence) ++answer;
    const bool answered =
        answer < record.torque.size() && record.torque[answer].answered_sequence == encoder.sequence;
    for (int g = 0; g < record.group_count; ++g) {
      const auto i = static_cast<std::size_t>(g);
      replay.motor_torque[i].push_back(output.motor_torque[i]);
      if (!answered) continue;
      const double recorded = record.torque[answer].motor_torque[i];
      const double difference = recorded - output.motor_torque[i];
      square += recorded * recorded;
      difference_square += difference * difference;
      replay.difference.push_back(difference);
      if (std::fabs(difference) > replay.largest_difference) {
        replay.largest_difference = std::fabs(difference);
        replay.largest_time = static_cast<double>(encoder.simulated_time) * 1e-9;
      }
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
