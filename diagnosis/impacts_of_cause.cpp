#include "diagnosis/impacts_of_cause.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "diagnosis/admit.h"
#include "diagnosis/fit.h"
#include "diagnosis/parameters_alone.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kLeftElsewhere = 0.1;  // of the mean square, at most, where impacts rule the residual; chosen
constexpr double kLeastBefore = 0.02;    // share of a record that must lie before its first impacts for its beginning to be told by that; chosen

std::size_t judged_points(const Whitening& whitening) {
  return static_cast<std::size_t>(std::count_if(whitening.window.begin(), whitening.window.end(), [](double weight) { return weight > 0.0; }));
}

// Where the machine's teeth are apart, or pressed by less than it misses: then nobody knows.
std::vector<bool> may_be_apart(const Shadow& shadow) {
  std::vector<bool> apart = shadow.contact_lost;
  for (const std::vector<double>& missing : shadow.missing_torque) {
    for (std::size_t n = 0; n < missing.size(); ++n) {
      if (shadow.holding_torque[n] < std::fabs(missing[n])) apart[n] = true;
    }
  }
  return apart;
}

void whiten_on(Problem& problem, const sim::MachineSettings& admitted, const WhiteningSettings& settings) {
  sim::MachineSettings machine = std::exchange(problem.nominal, admitted);
  whiten_again(problem, settings);
  problem.nominal = std::move(machine);
}

// Of each record whether its points are known to lie near a cause's impacts.
using Impacts = std::vector<std::vector<bool>>;

void swap_impacts(Problem& problem, Impacts& impacts) {
  for (std::size_t r = 0; r < impacts.size(); ++r) impacts[r] = problem.records.set_impacts(r, std::move(impacts[r]));
}

// All points from the first one on at which the nominal machine's teeth are apart, of records that begin on a machine that has moved before.
Impacts behind_first_impacts(const Problem& problem) {
  const Point nominal{std::vector<double>(nuisance_count(problem), 0.0), {}, 0};
  Impacts behind(problem.records.size());
  for (std::size_t r = 0; r < behind.size(); ++r) {
    behind[r] = problem.records[r].impacts_of_cause;
    if (problem.nuisances.begins[r] == RecordBegins::unmoved) continue;
    const std::vector<bool> apart = shadow_at(problem, nominal, r).contact_lost;
    const auto first = std::find(apart.begin(), apart.end(), true);
    if (first == apart.end()) continue;
    behind[r].resize(apart.size(), false);
    std::fill(behind[r].begin() + (first - apart.begin()), behind[r].end(), true);
  }
  return behind;
}

}  // namespace

std::optional<FitResult> begun_before_impacts(Problem& problem, const sim::MachineSettings& admitted, const WhiteningSettings& settings) {
  Impacts impacts = behind_first_impacts(problem);
  std::vector<Whitening> whitening = problem.whitening;
  swap_impacts(problem, impacts);
  whiten_on(problem, admitted, settings);
  bool is_changed = false, can_be_judged = true;
  for (std::size_t r = 0; r < whitening.size(); ++r) {
    is_changed |= problem.whitening[r].window != whitening[r].window;
    can_be_judged &= static_cast<double>(judged_points(problem.whitening[r])) >= kLeastBefore * static_cast<double>(problem.records[r].size());
  }
  std::optional<FitResult> begun;
  if (is_changed && can_be_judged) begun = nominal_with_beginnings(problem, fit_parameters_alone(problem, nominal_fit(problem)));
  swap_impacts(problem, impacts);
  problem.whitening = std::move(whitening);
  return begun;
}

double take_out_impacts(Problem& problem, const sim::MachineSettings& admitted, const WhiteningSettings& settings, const Point& cause) {
  const double before = mean_square(differences(problem, cause));
  if (before <= kNoiseAlone) return 0.0;
  const std::size_t count = problem.records.size();
  Impacts impacts(count);
  bool has_more = false;
  for (std::size_t r = 0; r < count; ++r) {
    impacts[r] = may_be_apart(shadow_at(problem, cause, r));
    const std::vector<bool>& known = problem.records[r].impacts_of_cause;
    for (std::size_t n = 0; n < impacts[r].size(); ++n) {
      has_more |= impacts[r][n] && problem.whitening[r].window[n] > 0.0;
      if (!known.empty() && known[n]) impacts[r][n] = true;
    }
  }
  if (!has_more) return 0.0;
  std::vector<Whitening> whitening = problem.whitening;
  swap_impacts(problem, impacts);
  whiten_on(problem, admitted, settings);
  std::size_t taken = 0, points = 0;
  bool can_be_judged = true;
  for (std::size_t r = 0; r < count; ++r) {
    const std::size_t judged = judged_points(problem.whitening[r]), all = problem.records[r].size();
    taken += judged_points(whitening[r]) - judged;
    points += all;
    can_be_judged &= static_cast<double>(judged) >= kLeastTrusted * static_cast<double>(all);
  }
  if (can_be_judged && mean_square(differences(problem, cause)) < kLeftElsewhere * before) return static_cast<double>(taken) / static_cast<double>(points);
  problem.whitening = std::move(whitening);
  swap_impacts(problem, impacts);
  return 0.0;
}

}  // namespace slewlab::diagnosis
