#include "diagnosis/rounding.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace slewlab::diagnosis {

namespace {

// [steps] by which a multiple may be missed: the least change is known to so many digits of itself, and anything is near a multiple of what is far smaller.
double tolerance(double multiple) { return std::min(0.1, 1e-3 * std::max(1.0, multiple)); }

constexpr double kFitting = 0.99;  // of the changes; a value now and then may have been mended
// [steps] by which a multiple may be missed of counts that were written to a few digits. Of changes that are multiples of nothing an eighth is that near to one.
constexpr double kWritten = 0.06;
constexpr std::size_t kMultiples = 3;  // at least: what moves steadily changes by much the same all the time, and was not counted

// The step that nearly all changes are multiples of, each but for the digits to which it was written: known the better the larger the multiples are that it was found in. 0: none.
double step_of_written(std::vector<double> changes) {
  std::sort(changes.begin(), changes.end());
  double step = changes.front(), products = 0.0, squares = 0.0;
  std::size_t fitting = 0;
  std::set<double> multiples;
  for (const double change : changes) {
    const double multiple = std::round(change / step);
    if (std::fabs(change / step - multiple) >= kWritten) continue;
    ++fitting;
    multiples.insert(multiple);
    products += change * multiple;
    squares += multiple * multiple;
    step = products / squares;
  }
  const bool is_step = multiples.size() >= kMultiples && static_cast<double>(fitting) > kFitting * static_cast<double>(changes.size());
  return is_step ? step : 0.0;
}

}  // namespace

Rounding find_rounding(const std::vector<double>& values, std::size_t least_changes, std::size_t least_levels) {
  double step = 0.0;
  std::vector<double> changes;
  for (std::size_t n = 1; n < values.size(); ++n) {
    const double change = std::fabs(values[n] - values[n - 1]);
    if (change == 0.0) continue;
    step = changes.empty() ? change : std::min(step, change);
    changes.push_back(change);
  }
  if (changes.empty() || changes.size() < least_changes) return {};
  const auto fitting = std::count_if(changes.begin(), changes.end(), [&](double change) {
    const double multiple = change / step;
    return std::fabs(multiple - std::round(multiple)) < tolerance(multiple);
  });
  if (static_cast<double>(fitting) <= kFitting * static_cast<double>(changes.size())) {
    step = step_of_written(changes);
    if (step == 0.0) return {};
  }
  std::set<long long> levels;
  for (std::size_t n = 0; n < values.size() && levels.size() < least_levels; ++n) levels.insert(std::llround((values[n] - values.front()) / step));
  if (levels.size() < least_levels) return {};
  const auto changed = static_cast<std::size_t>(std::count_if(changes.begin(), changes.end(), [&](double change) { return change > 0.5 * step; }));
  return {step, 2 * (values.size() - 1 - changed) > values.size()};
}

}  // namespace slewlab::diagnosis
