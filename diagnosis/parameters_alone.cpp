#include "diagnosis/parameters_alone.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "diagnosis/quiet_beginnings.h"

namespace slewlab::diagnosis {

namespace {

// From far off a fit goes as if it did not know the noise's size and, where its residual then is more than noise, as if it nearly did: contacts make
// the differences uneven, and one way may end where another does not.
constexpr std::array<double, 3> kFromAfar{1.0, 100.0, 10.0};
constexpr double kNearTheNoise = 10.0;  // mean square, beyond which parameters are hardly all that is missing, and one way is enough
constexpr double kCostOfNoise = 50.0;   // of parameters that leave noise alone, chosen: what they cost is their prior's
constexpr double kAtTheBound = 1.9;     // [standard deviations]

// Parameters alone at the floor of their valley, from where they are and, should that be more than noise, from the nominal machine with its beginnings fitted: nothing where noise is not all that they leave there, for
// beside an effect their floor is farther from the machine than where they stopped.
std::optional<FitResult> noise_alone_at_the_floor(Problem& problem, const FitResult& nominal, const FitResult& fitted) {
  FitResult floor = fitted;
  const auto settle_there = [&](FitResult& one) {
    settle_to_the_floor(problem, one, problem.settings.rounds, kCostOfNoise);
    return mean_square(one.difference) <= 1.0;
  };
  if (settle_there(floor)) return floor;
  std::optional<FitResult> begun = nominal_with_beginnings(problem, nominal);
  if (begun && settle_there(*begun)) return begun;
  return {};
}

}  // namespace

FitResult fit_parameters_alone(Problem& problem, const FitResult& nominal, const std::optional<Point>& ended_otherwise) {
  std::optional<FitResult> best_yet;
  bool has_met = false;  // two ways
  const auto settle_from = [&](FitResult one) {
    settle_until_idle(problem, one);
    has_met = best_yet && std::fabs(one.cost - best_yet->cost) <= problem.settings.settled;
    if (!best_yet || one.cost < best_yet->cost) best_yet = std::move(one);
  };
  // From the nominal machine directly as well: beside an effect that no parameter follows, a way from far parameters ends at a wrong one.
  const auto try_from_afar = [&](std::optional<double> times) {
    if (has_met || (best_yet && mean_square(best_yet->difference) <= 1.0)) return;
    FitResult one = nominal;
    begin_anew(problem, one);
    if (times) settle_from_afar(problem, one, *times, problem.settings.rounds);
    settle_from(std::move(one));
  };
  const auto anew_at = [&](Point start) {
    FitResult one = fit_at(problem, std::move(start));
    begin_anew(problem, one);
    return one;
  };
  if (ended_otherwise) settle_from(anew_at(*ended_otherwise));
  for (const double times : kFromAfar) {
    if (!best_yet || mean_square(best_yet->difference) < kNearTheNoise) try_from_afar(times);
  }
  try_from_afar(std::nullopt);
  FitResult& best = *best_yet;
  const auto take_cheaper = [&](FitResult one) {
    settle_until_idle(problem, one);
    if (one.cost < best.cost) best = std::move(one);
  };
  // Parameters that ended at the bounds of their spread may have gone there on the way and not come back.
  Point within = best.point;
  for (std::size_t k = 0; k < problem.nuisances.parameters.size(); ++k) {
    if (std::fabs(within.nuisance[k]) > kAtTheBound) within.nuisance[k] = 0.0;
  }
  if (within.nuisance != best.point.nuisance) take_cheaper(anew_at(std::move(within)));
  Point quiet = best.point;
  if (quieten_beginnings(problem.nuisances, quiet)) take_cheaper(anew_at(std::move(quiet)));
  // Parameters that went along with a beginning that was not found yet do not come back from there either, once it is.
  if (mean_square(best.difference) > 1.0) {
    std::optional<FitResult> begun = nominal_with_beginnings(problem, best);
    if (begun && begun->cost < best.cost) take_cheaper(std::move(*begun));
  }
  if (std::optional<FitResult> floor = noise_alone_at_the_floor(problem, nominal, best)) best = std::move(*floor);
  conclude(problem, best);
  return std::move(best);
}

bool all_begin_unmoved(const Problem& problem) {
  const std::vector<RecordBegins>& begins = problem.nuisances.begins;
  return std::all_of(begins.begin(), begins.end(), [](RecordBegins one) { return one == RecordBegins::unmoved; });
}

std::optional<FitResult> nominal_with_beginnings(Problem& problem, const FitResult& fitted) {
  if (all_begin_unmoved(problem)) return {};
  Point begun;
  begun.nuisance = fitted.point.nuisance;
  std::fill_n(begun.nuisance.begin(), problem.nuisances.common_count(), 0.0);
  FitResult result = fit_at(problem, std::move(begun));
  fit_beginnings(problem, result);
  return result;
}

}  // namespace slewlab::diagnosis
