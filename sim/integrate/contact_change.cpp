#include "sim/integrate/contact_change.h"

#include <algorithm>
#include <cmath>

// Vectors are passed between functions that are all put in line.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace slewlab::sim {
namespace {

constexpr double kRounding = 1e-12;  // [-] of angles, more than the cubic of a deflection loses

// Whether the deflection's cubic turns too far from the edge to reach it: from the straight line between its ends it is off by less than
// the way that its start and end rates would go in the step, and its rate from twice the mean rate by less than their sum.
bool turns_far_from_edge(const GearContact& gear, int contact, int side, const Deflection& d) {
  const double rates = std::fabs(d.start_rate) + std::fabs(d.end_rate);
  const double reach = d.length * rates + kRounding * (std::fabs(d.start) + std::fabs(d.end));
  if (contact == 0) return std::max(side * d.start, side * d.end) + reach < gear.half_play;
  const double fastest = 2.0 * std::fabs(d.end - d.start) / d.length + rates;
  return std::min(side * d.start, side * d.end) - gear.half_play - reach - gear.damping / gear.stiffness * fastest > 0.0;
}

using Points [[gnu::vector_size(16)]] = double;  // as every 64-bit processor has them

// Halves [before, after] towards where `is_beyond` begins and returns `after`. Three times at once: all places that may come next are asked
// together, and the way through them is found without a branch that the processor would have to guess.
template <class IsBeyond>
[[gnu::always_inline]] inline double halved(double before, double after, int halvings, const IsBeyond& is_beyond) {
  for (; halvings >= 3; halvings -= 3) {
    const double middle = 0.5 * (before + after);
    if (middle == before || middle == after) return after;  // neighbouring numbers: no halving moves them
    const double left = 0.5 * (before + middle), right = 0.5 * (middle + after);
    const double places[] = {before, 0.5 * (before + left), left,  0.5 * (left + middle), middle, 0.5 * (middle + right), right, 0.5 * (right + after),
                             after};
    const auto left_half = is_beyond(Points{left, middle}), right_half = is_beyond(Points{right, middle});
    const auto left_quarters = is_beyond(Points{places[1], places[3]}), right_quarters = is_beyond(Points{places[5], places[7]});
    const bool in_left = left_half[1] != 0;
    const auto quarters = in_left ? left_quarters : right_quarters;
    const bool in_first = (in_left ? left_half[0] : right_half[0]) != 0;
    const bool in_begin = (in_first ? quarters[0] : quarters[1]) != 0;
    const int eighth = (in_left ? 0 : 4) + (in_first ? 0 : 2) + (in_begin ? 0 : 1);
    before = places[eighth];
    after = places[eighth + 1];
  }
  for (; halvings > 0; --halvings) {
    const double middle = 0.5 * (before + after);
    (is_beyond(Points{middle, middle})[0] != 0 ? after : before) = middle;
  }
  return after;
}

}  // namespace

double first_change(const GearContact& gear, int contact, int side, const Deflection& d) {
  const auto measure = [&](double at) {
    return change_measure(gear, contact, side, d.value(at), d.rate(at));
  };
  double after = 1.0;
  if (change_measure(gear, contact, side, d.end, d.end_rate) <= 0.0) {
    // Both ends keep the contact; it may still have changed where the deflection turns inside the step.
    if (turns_far_from_edge(gear, contact, side, d)) return 2.0;
    const double towards = contact != 0 ? -side : side;
    after = halved(0.0, 1.0, 50, [&](const Points& at) { return ~(towards * d.rate(at) > 0.0); });
    if (measure(after) <= 0.0) return 2.0;
  }
  if (measure(0.0) > 0.0) return 0.0;
  return halved(0.0, after, 60, [&](const Points& at) { return change_measure<Points>(gear, contact, side, d.value(at), d.rate(at)) > 0.0; });
}

}  // namespace slewlab::sim
