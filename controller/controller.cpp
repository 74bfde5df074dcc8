#include "controller/controller.h"

#include <algorithm>
#include <cmath>

#include "controller/speed_filter.h"

namespace slewlab::controller {
namespace {

bool is_usable(const ControllerSettings& settings, const ControllerInput& input) {
  if (input.unusable_reading || input.group_count != settings.group_count) return false;
  for (int i = 0; i < input.group_count; ++i) {
    if (!std::isfinite(input.shaft_speed[i])) return false;
  }
  return true;
}

void step_mode_and_ramp(const ControllerSettings& settings, ControllerState& state,
                        const ControllerInput& input, double speed_request) {
  if (input.emergency_stop) state.mode = Mode::emergency_stop;

  if (state.mode == Mode::emergency_stop || state.mode == Mode::waiting_for_acknowledgement) {
    step_emergency_stop(settings.ramp, state.ramp, settings.period);
    const bool at_zero = !state.ramp.moving;
    if (at_zero && !input.emergency_stop) {
      const bool acknowledged = input.acknowledge && speed_request == 0.0;
      state.mode = acknowledged ? Mode::stopped : Mode::waiting_for_acknowledgement;
    }
    return;
  }

  step_ramp(settings.ramp, state.ramp, settings.period, speed_request * settings.ramp.top_speed);
  const bool moving = state.ramp.target != 0.0 || state.ramp.moving;
  state.mode = moving ? Mode::running : Mode::stopped;
}

// With play compensation the groups share one integral, their mean. The compensation moves the groups apart
// by their play, and integrals of their own would take that for an error to be worked off: they would cancel
// the offset, and the torques would leave the map of Table 3.4. The proportional parts stay each group's own
// and damp the motion of the groups against each other.
void share_integral(const ControllerSettings& settings, ControllerState& state) {
  double mean = 0.0;
  for (int i = 0; i < settings.group_count; ++i) mean += state.speed_control[i].integral_torque;
  mean /= settings.group_count;
  for (int i = 0; i < settings.group_count; ++i) state.speed_control[i].integral_torque = mean;
}

// Everything starts anew from standstill once the operator has acknowledged.
void let_go(const ControllerSettings& settings, ControllerState& state, ControllerOutput& output) {
  state = ControllerState{};
  state.mode = Mode::waiting_for_acknowledgement;
  state.unusable_measurement = true;
  output = ControllerOutput{};
  output.group_count = settings.group_count;
  output.brake = true;
  output.mode = state.mode;
}

}  // namespace

void step(const ControllerSettings& settings, ControllerState& state, const ControllerInput& input,
          ControllerOutput& output) {
  const double speed_request =
      std::isfinite(input.speed_request) ? std::clamp(input.speed_request, -1.0, 1.0) : 0.0;

  const bool is_passed_on = input.acknowledge && speed_request == 0.0;
  const bool acknowledged = is_passed_on && !input.emergency_stop;
  const bool stays_off = state.unusable_measurement && !acknowledged;
  if (!is_usable(settings, input) || stays_off) {
    let_go(settings, state, output);
    output.acknowledge = is_passed_on;
    return;
  }
  state.unusable_measurement = false;

  step_mode_and_ramp(settings, state, input, speed_request);

  const int groups = settings.group_count;
  const double reference = state.ramp.speed * settings.total_ratio;
  double average = 0.0;
  PerGroup controlled{};
  for (int i = 0; i < groups; ++i) {
    const double previous = state.started ? state.filtered_speed[i] : input.shaft_speed[i];
    state.filtered_speed[i] =
        filtered_speed(settings.speed_filter_time, settings.period, previous, input.shaft_speed[i]);
    const SpeedControlOutput control =
        step_speed_control(settings.speed_control, state.speed_control[i], settings.period,
                           reference - state.filtered_speed[i], settings.rated_torque, settings.limits.torque);
    controlled[i] = control.torque;
    output.proportional_torque[i] = control.proportional_torque;
    average += control.torque;
  }
  average /= groups;
  state.started = true;
  const bool compensates = is_enabled(settings.play_compensation, input.simulated_time);
  if (compensates) share_integral(settings, state);

  HalfTorques added{};  // [N m] per motor
  if (compensates) {
    const HalfTorques mapped =
        evaluate_play_map(settings.play_compensation, average / settings.rated_torque);
    added.half_1 = mapped.half_1 * settings.rated_torque - average;
    added.half_2 = mapped.half_2 * settings.rated_torque - average;
  }
  bool any_offset = false;
  for (int i = 0; i < groups; ++i) {
    const int half = half_of_group(i, groups);
    any_offset = any_offset || half != 0;
    const double offset = half == 1 ? added.half_1 : half == 2 ? added.half_2 : 0.0;
    state.commanded_torque[i] = limited_torque(settings.limits, settings.period, state.commanded_torque[i],
                                               controlled[i] + offset);
    output.motor_torque[i] = state.commanded_torque[i];
    output.integral_torque[i] = state.speed_control[i].integral_torque;
  }

  output.group_count = groups;
  output.enable = true;
  output.brake = false;
  output.acknowledge = is_passed_on;
  output.mode = state.mode;
  output.ramped_speed = state.ramp.speed;
  output.average_torque = average;
  output.offset_torque = any_offset ? 0.5 * (added.half_1 - added.half_2) : 0.0;
}

}  // namespace slewlab::controller
