#include "controller/process/computed_answer.h"

#include <algorithm>

namespace slewlab::controller {
namespace {

void copy_per_group(const PerGroup& from, int count, std::vector<double>& to) {
  to.assign(from.begin(), from.begin() + count);
}

}  // namespace

void take_reading(const ControllerSettings& settings, const msgs::Encoder& encoder, PlausibilityState& plausibility, ControllerInput& input) {
  EncoderReading reading;
  reading.sequence = encoder.sequence;
  reading.simulated_time = encoder.simulated_time;
  // The pure controller knows what to do about a number of groups that is not its own.
  reading.group_count = encoder.group_count;
  const int groups = std::min(encoder.group_count, kMaximumGroups);
  std::copy_n(encoder.shaft_speed.begin(), groups, reading.shaft_speed.begin());
  std::copy_n(encoder.shaft_position.begin(), groups, reading.shaft_position.begin());
  const Plausibility judged = judge(settings.plausibility, settings.period, settings.group_count, plausibility, reading);
  input.simulated_time = encoder.simulated_time;
  input.group_count = reading.group_count;
  input.shaft_speed = reading.shaft_speed;
  input.unusable_reading = judged == Plausibility::unusable;
}

Compute computed_answer(const ControllerSettings& settings, const std::vector<PlaySwitch>* switched) {
  return [own = settings, switched, known = std::size_t{0}, state = ControllerState{}, plausibility = PlausibilityState{},
          input = ControllerInput{}, output = ControllerOutput{}](
             const msgs::Encoder& encoder, const msgs::Operator& operator_move, msgs::Torque& torque,
             msgs::ControllerState& report) mutable {
    for (; switched != nullptr && known < switched->size(); ++known) add_switch(own.play_compensation, (*switched)[known]);
    take_reading(own, encoder, plausibility, input);
    input.speed_request = operator_move.speed_request;
    input.emergency_stop = operator_move.emergency_stop;
    input.acknowledge = operator_move.acknowledge;
    step(own, state, input, output);
    torque.enable = output.enable;
    torque.brake = output.brake;
    torque.acknowledge = output.acknowledge;
    torque.group_count = output.group_count;
    copy_per_group(output.motor_torque, output.group_count, torque.motor_torque);
    report.mode = static_cast<std::int8_t>(output.mode);
    report.ramped_speed = output.ramped_speed;
    report.average_torque = output.average_torque;
    report.offset_torque = output.offset_torque;
    report.group_count = output.group_count;
    copy_per_group(output.proportional_torque, output.group_count, report.proportional_torque);
    copy_per_group(output.integral_torque, output.group_count, report.integral_torque);
  };
}

}  // namespace slewlab::controller
