#include "diagnosis/median_deviation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace slewlab::diagnosis {

double median_deviation(std::vector<double> values) {
  if (values.empty()) return 0.0;
  for (double& value : values) value = std::fabs(value);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle / 0.6745;
}

}  // namespace slewlab::diagnosis
