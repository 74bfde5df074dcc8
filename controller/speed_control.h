// The PI speed controller of one motor group with droop (thesis 3.5, 2.3, appendix D as the notes give it).
//
//   e = omega_ref - omega - k_droop T / T100,   T = Kp e + I,   dI/dt = Kp / Ti e
// on the fast axis, all torques per motor. The droop's T is the one being computed: the loop is solved for
// it, so it needs no delayed value. The integral is taken by the trapezoidal rule, so one set of gains
// serves every controller period.
// Anti-windup: T is held within +-limit, and the integral does not grow in the direction of a limit at
// which T stands.
#pragma once

namespace slewlab::controller {

struct SpeedControlSettings {
  double proportional_gain = 0.0;  // [N m s/rad] per motor
  double integral_time = 0.0;      // [s]
  double droop = 0.0;              // [rad/s] on the fast axis at rated torque; 0 is off
};

struct SpeedControlState {
  double integral_torque = 0.0;  // [N m] per motor
  double error = 0.0;            // [rad/s] of the step before
};

struct SpeedControlOutput {
  double torque = 0.0;               // [N m] per motor, within the limit
  double proportional_torque = 0.0;  // [N m] per motor
};

SpeedControlOutput step_speed_control(const SpeedControlSettings& settings, SpeedControlState& state,
                                      double period, double speed_error, double rated_torque,
                                      double torque_limit);

}  // namespace slewlab::controller
