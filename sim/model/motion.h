// A prescribed motion over time, as a winch, a luffing gear or a travelling gear makes it: requests of speed, brought about by
// ramps that keep within the drive's acceleration.
//
// A ramp from v_0 to v_1 within T is the cubic v_0 + (v_1 - v_0) (3 s^2 - 2 s^3), s = t / T, whose acceleration has no steps and is at most
// 1.5 |v_1 - v_0| / T. A request that comes while a ramp is under way begins with that ramp's speed and acceleration a_0:
//   v = v_0 + (v_1 - v_0) (3 s^2 - 2 s^3) + a_0 T (s^3 - 2 s^2 + s),   T >= 2.25 |v_1 - v_0| / a,
// which keeps |dv/dt| <= a wherever |a_0| <= a. Speeds and accelerations in whatever unit the motion has per second.
#pragma once

#include <cstdint>
#include <vector>

namespace slewlab::sim {

// What a drive can do.
struct MotionRates {
  double top_speed = 0.0;     // [m/s] or [rad/s]; 0 where the crane has no such motion
  double acceleration = 0.0;  // [m/s^2] or [rad/s^2]
};

struct MotionRequest {
  std::int64_t time = 0;  // [ns]
  double share = 0.0;     // [-] -1 ... 1 of the top speed
};

// What is asked of the crane's motions beside slewing, each by rising time.
struct MotionRequests {
  std::vector<MotionRequest> hoisting, luffing, travelling;

  bool empty() const { return hoisting.empty() && luffing.empty() && travelling.empty(); }
};

struct MotionState {
  double way = 0.0, speed = 0.0, acceleration = 0.0;
};

class MotionProfile {
 public:
  MotionProfile() = default;
  // `requests` by rising time. Nothing moves before the first.
  MotionProfile(const MotionRates& rates, const std::vector<MotionRequest>& requests);

  bool is_still() const { return ramps_.empty(); }
  // [s] when the first ramp begins; only where it moves.
  double begin() const { return ramps_.front().begin; }
  MotionState at(double time) const;
  // Whether it moves anywhere in (from, to].
  bool moves_within(double from, double to) const;
  // Least and largest way up to `until` [s].
  double least(double until) const;
  double largest(double until) const;

 private:
  struct Ramp {
    double begin;  // [s]
    double time;   // [s] that it takes
    double way, speed, acceleration;  // at its begin
    double change;  // of the speed
  };
  static MotionState at(const Ramp& ramp, double time);
  double furthest(double until, double side) const;  // to the side +1 or -1

  std::vector<Ramp> ramps_;
};

}  // namespace slewlab::sim
