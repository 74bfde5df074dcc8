// The ramp between the requested and the commanded slewing speed (thesis 2.3, 4.5).
//
// S-curve: the acceleration is a trapezoid. A speed change dv takes T = T_full |dv| / top_speed, so half
// the change takes half the time and its curved shares shorten with it (thesis 4.5); a share c of T is
// curved at each end, where the acceleration changes linearly:
//   [0, cT] a0 -> a_p,   [cT, (1-c)T] a_p,   [(1-c)T, T] a_p -> 0,
//   a_p = (dv - a0 c T / 2) / ((1 - c) T),
// so that the area is dv. From rest, a0 = 0 and a_p = top_speed / (T_full (1 - c)) whatever the change.
// Retargeting starts a new profile from the speed and the acceleration of that moment: both stay
// continuous. Its T is at least 2 c T_full |a0| / a_full, the time that a curved start and end need to
// carry a0 away, so that the jerk stays bounded even where the new target is the present speed.
// T_full is the acceleration time for the part of the change that leads away from zero speed and the
// deceleration time for the part towards it.
//
// Linear: the acceleration is top_speed / T_full during the change and zero outside. The emergency stop is
// linear with its own time (thesis 4.2, "an engineered emergency stop using a linear ramp").
//
// Speeds are those of the slew axis [rad/s]; times [s].
#pragma once

namespace slewlab::controller {

enum class RampShape { s_curve, linear };

struct RampSettings {
  RampShape shape = RampShape::s_curve;
  double top_speed = 0.0;            // [rad/s]
  double acceleration_time = 0.0;    // [s] from 0 to top speed
  double deceleration_time = 0.0;    // [s] from top speed to 0
  double emergency_stop_time = 0.0;  // [s] from top speed to 0
  double curved_share = 0.0;         // [-] of the time, at each end, 0 ... 0.5
};

struct RampState {
  double speed = 0.0;         // [rad/s] commanded now
  double acceleration = 0.0;  // [rad/s^2] now
  double target = 0.0;        // [rad/s] towards which the profile leads
  bool stopping = false;      // the profile is the emergency stop's

  double elapsed = 0.0;             // [s] since the profile began
  double duration = 0.0;            // [s] of the profile; 0 when there is none
  double curved_time = 0.0;         // [s] of each curved end
  double start_speed = 0.0;         // [rad/s]
  double start_acceleration = 0.0;  // [rad/s^2]
  double peak_acceleration = 0.0;   // [rad/s^2] of the middle part
};

// Moves the profile on by `period`, then takes up a new target (clamped to +-top speed). A change of target
// therefore shows in the speed one period after it is given.
void step_ramp(const RampSettings& settings, RampState& state, double period, double target);

// The same for the emergency stop: linear to zero from whatever the ramp is doing.
void step_emergency_stop(const RampSettings& settings, RampState& state, double period);

}  // namespace slewlab::controller
