// The regression of two records of a simulated axis, back and forth at several speeds, as a diagnosis makes it.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "diagnosis/balance/balance_priors.h"
#include "diagnosis/balance/balance_setup.h"
#include "tests/diagnosis/balance/simulated_axis.h"

namespace slewlab::diagnosis {

struct PreparedAxis {
  std::vector<BalanceRecord> records;
  Balance balance;
  Regression regression;
};

// As dry friction and viscous friction of a real axis.
inline double usual_friction(double, double, double speed) { return 1.2 * std::tanh(speed / 1e-3) + 0.8 * speed; }

inline std::vector<AxisRecord> two_records(SimulatedAxis axis) {
  std::vector<AxisRecord> records;
  axis.effort = [](double time) { return 6.0 * std::sin(1.1 * time) + 4.0 * std::sin(2.7 * time + 1.0); };
  records.push_back(record_of(axis));
  axis.effort = [](double time) { return 5.0 * std::sin(1.6 * time + 0.4) + 4.0 * std::sin(0.9 * time); };
  ++axis.seed;
  records.push_back(record_of(axis));
  return records;
}

inline PreparedAxis prepared_axis(const SimulatedAxis& axis, double nominal_inertia = 2.0) {
  constexpr double kTopSpeed = 8.0;  // [rad/s]
  const std::vector<AxisRecord> records = two_records(axis);
  Balance balance = balance_of(records, nominal_inertia, kTopSpeed, true);
  std::vector<BalanceRecord> smooth = smoothed(records, balance);
  Regression regression = prepared_regression(smooth, balance.laws, nominal_inertia, balance.resolved_speed);
  return {std::move(smooth), std::move(balance), std::move(regression)};
}

// The laws of these names, each in its first shape.
inline LawChoice choice_of(const std::vector<BalanceLaw>& laws, const std::vector<std::string>& names) {
  LawChoice choice;
  for (const std::string& name : names) choice.laws.push_back(chosen_law(laws, name).value());
  return choice;
}

}  // namespace slewlab::diagnosis
