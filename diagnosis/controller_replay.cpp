#include "diagnosis/controller_replay.h"

#include <fmt/format.h>

#include <cmath>

namespace slewlab::diagnosis {

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
  for (const msgs::Encoder& encoder : record.encoder) {
    while (move < record.operator_moves.size() &&
           record.operator_moves[move].simulated_time <= encoder.simulated_time) {
      input.speed_request = record.operator_moves[move].speed_request;
      input.emergency_stop = record.operator_moves[move].emergency_stop;
      input.acknowledge = record.operator_moves[move].acknowledge;
      ++move;
    }
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
