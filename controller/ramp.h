// The ramp between the requested and the commanded slewing speed (thesis 2.3, 4.5).
//
// S-curve: the acceleration is a trapezoid. A speed change dv takes T = T_full |dv| / top_speed, so half
// the change takes half the time and its curved shares shorten with it (thesis 4.5); a share c of T is
// curved at each end, where the acceleration changes linearly. From rest that is
//   jerk j = a_full / (c T) until a_full = |dv| / (T (1 - c)), constant, then -j until 0.
// T_full is the acceleration time for the part of the change that leads away from zero speed and the
// deceleration time for the part towards it.
// Retargeting while the acceleration is a0 starts a new profile from the speed and acceleration of that
// moment; both stay continuous:
//   a0 -> a_p at the jerk j, a_p constant, a_p -> 0 at j,
//   a_p^2 = d j (v1 - v0) + a0^2 / 2, at most a_full^2,
//   d = sign(v1 - v0 - a0 |a0| / (2 j)), the direction left over when a0 is taken away at once.
// The jerk then only ever gets smaller, and only where a0 leads to the new target, so no profile swings
// past the target before it: the speed never passes top speed, and a target that trembles in every cycle
// is approached as if it stood still.
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
  bool moving = false;        // a profile is under way
  bool stopping = false;      // the profile is, or was, the emergency stop's

  // The profile: the acceleration goes from start to peak, stays there, goes to zero.
  double elapsed = 0.0;             // [s] since the profile began
  double rise_time = 0.0;           // [s]
  double hold_time = 0.0;           // [s]
  double fall_time = 0.0;           // [s]
  double start_speed = 0.0;         // [rad/s]
  double start_acceleration = 0.0;  // [rad/s^2]
  double peak_acceleration = 0.0;   // [rad/s^2]
  double jerk = 0.0;                // [rad/s^3] of rise and fall; 0 for a linear profile
};

// Moves the profile on by `period`, then takes up a new target (clamped to +-top speed). A change of target
// therefore shows in the speed one period after it is given.
void step_ramp(const RampSettings& settings, RampState& state, double period, double target);

// The same for the emergency stop: linear to zero from whatever the ramp is doing.
void step_emergency_stop(const RampSettings& settings, RampState& state, double period);

}  // namespace slewlab::controller
