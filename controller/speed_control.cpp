#include "controller/speed_control.h"

#include <algorithm>

namespace slewlab::controller {

SpeedControlOutput step_speed_control(const SpeedControlSettings& settings, SpeedControlState& state,
                                      double period, double speed_error, double rated_torque,
                                      double torque_limit) {
  const double gain = settings.proportional_gain;
  const double half_step = 0.5 * period * gain / settings.integral_time;  // [N m s/rad]
  const double droop = settings.droop / rated_torque;                     // [rad/s per N m]

  // T = (Kp + half_step) e + I_old + half_step e_old  with  e = speed_error - droop T
  const double held = state.integral_torque + half_step * state.error;
  const double wanted = ((gain + half_step) * speed_error + held) / (1.0 + (gain + half_step) * droop);
  const double torque = std::clamp(wanted, -torque_limit, torque_limit);
  const double error = speed_error - droop * torque;

  const double growth = half_step * (error + state.error);
  const bool winds_up = (wanted > torque_limit && growth > 0.0) || (wanted < -torque_limit && growth < 0.0);
  if (!winds_up) state.integral_torque += growth;
  state.integral_torque = std::clamp(state.integral_torque, -torque_limit, torque_limit);
  state.error = error;
  return {torque, gain * error};
}

}  // namespace slewlab::controller
