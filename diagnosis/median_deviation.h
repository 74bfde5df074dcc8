// The deviation of what scatters about zero, by the median of its sizes, which a few values far off do not move: of a normal distribution that is 0.6745 of the deviation.
#pragma once

#include <vector>

namespace slewlab::diagnosis {

// In the values' unit; 0 of none.
double median_deviation(std::vector<double> values);

}  // namespace slewlab::diagnosis
