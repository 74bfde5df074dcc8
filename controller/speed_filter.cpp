#include "controller/speed_filter.h"

#include <cmath>

namespace slewlab::controller {

double filtered_speed(double time_constant, double period, double previous, double measured) {
  if (time_constant <= 0.0) return measured;
  return previous - std::expm1(-period / time_constant) * (measured - previous);
}

}  // namespace slewlab::controller
