// A first-order low-pass on a measured speed, exact for a measurement held over the period:
//   y += (1 - exp(-period / time_constant)) (u - y).  A time constant of 0 is no filter.
#pragma once

namespace slewlab::controller {

// The filtered speed [rad/s] after one period [s].
double filtered_speed(double time_constant, double period, double previous, double measured);

}  // namespace slewlab::controller
