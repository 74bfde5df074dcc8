// The nominal crane's numbers that are never quite right on a real machine, each with its spread from unit to
// unit. A wrong one imitates a missing effect and the other way round, so every hypothesis is fitted with all
// of them free under their priors.
#pragma once

#include <string_view>
#include <vector>

#include "sim/model/crane_parameters.h"

namespace slewlab::diagnosis {

struct Nuisance {
  std::string_view name;
  double spread;  // [-] one standard deviation of the factor on the nominal value
  void (*scale)(sim::CraneParameters&, double factor);
};

// 5 % either way with equal chance is a standard deviation of 5 % / sqrt(3).
inline constexpr double kUnitSpread = 0.05;                     // [-] half range from unit to unit (issue 4)
inline constexpr double kUnitDeviation = kUnitSpread / 1.7320508075688772;  // [-]

const std::vector<Nuisance>& nuisances();

// The nominal crane with every nuisance moved by `amount[k]` standard deviations.
sim::CraneParameters with_nuisances(sim::CraneParameters crane, const std::vector<double>& amount);

}  // namespace slewlab::diagnosis
