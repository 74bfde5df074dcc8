#include "sim/drive/run_cost.h"

#include <cmath>
#include <cstdio>

namespace slewlab::sim {
namespace {

// Two significant digits, thousands apart.
std::string rounded(double number) {
  const double unit = number < 100.0 ? 1.0 : std::pow(10.0, std::floor(std::log10(number)) - 1.0);
  char digits[32];
  std::snprintf(digits, sizeof digits, "%.0f", std::round(number / unit) * unit);
  std::string text = digits;
  for (int place = static_cast<int>(text.size()) - 3; place > 0; place -= 3) text.insert(static_cast<std::size_t>(place), " ");
  return text;
}

std::string duration_text(double seconds) {
  constexpr double kMinute = 60.0, kHour = 3600.0, kDay = 86400.0;  // [s]
  if (seconds < 2.0 * kMinute) return rounded(seconds) + " seconds";
  if (seconds < 2.0 * kHour) return rounded(seconds / kMinute) + " minutes";
  if (seconds < 2.0 * kDay) return rounded(seconds / kHour) + " hours";
  return rounded(seconds / kDay) + " days";
}

}  // namespace

RunCost run_cost(const Scenario& scenario) {
  constexpr double kStep = 151e-9, kStepPerElement = 14.9e-9;  // [s] docs/benchmarks.md, cost over 2 ... 64 elements
  constexpr double kPeriod = 20e-6;                            // [s] docs/benchmarks.md, lockstep with CONTROLLER_STATE
  constexpr double kAssembly = 1e-7;                           // [s] per element^3; docs/benchmarks.md
  if (scenario.plant_step <= 0 || scenario.controller_period <= 0) return {};
  const double duration = static_cast<double>(scenario.duration);
  const double elements = scenario.crane.parameters.boom.element_count;
  RunCost cost;
  cost.steps = duration / static_cast<double>(scenario.plant_step);
  cost.seconds = cost.steps * (kStep + kStepPerElement * elements) +
                 duration / static_cast<double>(scenario.controller_period) * kPeriod + kAssembly * elements * elements * elements;
  return cost;
}

std::string text_of(const RunCost& cost) {
  return "about " + rounded(cost.steps) + " plant steps, some " + duration_text(cost.seconds);
}

}  // namespace slewlab::sim
