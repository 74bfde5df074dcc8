// When, within a step, the teeth of a gear meet or leave each other: on the cubic through the gear deflection's values and rates at both
// ends of the step.
#pragma once

#include "sim/model/gear.h"

namespace slewlab::sim {

// Value and slope of the gear deflection on the cubic through both ends of the step; `at` is a share of it.
struct Deflection {
  double start, start_rate, end, end_rate, length;

  template <class Number>
  Number value(const Number& at) const {
    const Number at2 = at * at, at3 = at2 * at;
    return start * (2.0 * at3 - 3.0 * at2 + 1.0) + length * start_rate * (at3 - 2.0 * at2 + at) +
           end * (3.0 * at2 - 2.0 * at3) + length * end_rate * (at3 - at2);
  }
  template <class Number>
  Number rate(const Number& at) const {
    const Number at2 = at * at;
    return (end - start) * 6.0 * (at - at2) / length + start_rate * (3.0 * at2 - 4.0 * at + 1.0) +
           end_rate * (3.0 * at2 - 2.0 * at);
  }
};

// > 0 where the group's contact would change: teeth of flank `contact` that would pull, or free teeth that
// have met flank `side` and push.
template <class Number>
Number change_measure(const GearContact& gear, int contact, int side, const Number& deflection, const Number& rate) {
  const double flank = side;
  const Number depth = flank * deflection - gear.half_play;
  const Number push = depth + gear.damping / gear.stiffness * flank * rate;
  if (contact != 0) return -push;
  return push < depth ? push : depth;
}

// Whether the contact may change within the step: it has changed at the end, or the deflection turns on the way. Asked in every step.
[[gnu::always_inline]] inline bool may_change(const GearContact& gear, int contact, int side, const Deflection& d) {
  if (!(change_measure(gear, contact, side, d.end, d.end_rate) <= 0.0)) return true;
  const double towards = contact != 0 ? -side : side;
  return towards * d.start_rate > 0.0 && towards * d.end_rate < 0.0;
}

// The first share of the step at which the contact changes, 2 when it does not; where may_change() says yes. Never in line, so that
// the question stays small.
double first_change(const GearContact& gear, int contact, int side, const Deflection& d);

}  // namespace slewlab::sim
