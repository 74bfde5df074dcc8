// How the values of a record were rounded when they were written down, or counted when they were read: the step that all of them are multiples of. Its error is anything up to half of
// it, of variance step^2 / 12.
#pragma once

#include <cstddef>
#include <vector>

namespace slewlab::diagnosis {

struct Rounding {
  double step = 0.0;     // in the values' unit; 0: none found
  bool is_slow = false;  // the values mostly change by less than that, so that the error stays for long
};

// As far as so many changes show it. A signal that has few levels in all, as a test's that switches between some, was not rounded to them.
// Counts that were written to a few digits are multiples of their step but for those digits, up to some hundredths of the step.
Rounding find_rounding(const std::vector<double>& values, std::size_t least_changes, std::size_t least_levels);

// Of the error.
inline double variance_of(const Rounding& rounding) { return rounding.step * rounding.step / 12.0; }

}  // namespace slewlab::diagnosis
