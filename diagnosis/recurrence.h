// Where the friction of an axis that is missing comes again: a law that depends on the place through a length of the angle has a valley of its own for every
// length, so narrow that a fit only converges from nearby. The observer's missing torque tells the lengths without a simulation for each of them:
//
//   T(t) sign(w(t)) = a + b cos(2 pi theta(t) / l) + c sin(2 pi theta(t) / l),    least squares over all records where they are judged and the axis turns,
//
// with a, b and c of their own for each direction, because the observer lags; T the mean of the motors' missing torque, theta and w angle and speed of the axis. Tried are orders
// 1 / l, a quarter of what the angle that is passed tells apart from one to the next.
#pragma once

#include <cstddef>
#include <vector>

#include "diagnosis/problem.h"

namespace slewlab::diagnosis {

inline constexpr std::size_t kLengths = 2;  // that are tried: the first may be half of a law's with two harmonics

// [rad] The lengths at which the law above has the smallest residual of the missing torque of the machine at `point`. The best first, `most` of them
// at most, each farther from the others than the angle that is passed tells apart. None where the axis hardly turns.
std::vector<double> recurring_lengths(const Problem& problem, const Point& point, std::size_t most);

}  // namespace slewlab::diagnosis
