#include "diagnosis/own_noise_fit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "diagnosis/own_noise.h"
#include "diagnosis/screen.h"
#include "diagnosis/validate.h"
#include "sim/model/cannot_be_built.h"

namespace slewlab::diagnosis {

namespace {

constexpr int kRoundsEach = 4, kMoreRounds = 10;  // at most, from each start, and of the best of them; chosen
constexpr double kOffTheCentre = 1.5;              // deviations of its prior, by which a shape is moved; chosen
constexpr double kFarAbove = 10.0;                 // times the noise, above which a residual is hardly bent by what the noise is; chosen

bool is_another(double noise, double than) { return std::fabs(noise - than) > kNoise; }

// Nothing of a machine that is not there, because its boom buckles.
std::optional<double> noise_of(const Problem& problem, const Point& point) {
  try {
    return mean_square_of_noise(problem, point);
  } catch (const sim::CannotBeBuilt&) {
    return {};
  }
}

// With nominal parameters: its effects as they are, and with each of the shapes that change the noise moved to either side of its centre. None where neither changes it,
// or where the residual lies far above the noise of them all.
std::vector<Point> starts_of(const Problem& problem, const FitResult& fitted) {
  Point nominal = fitted.point;
  std::fill(nominal.nuisance.begin(), nominal.nuisance.end(), 0.0);
  const std::optional<double> noise = noise_of(problem, nominal);
  std::vector<Point> starts;
  if (!noise) return starts;
  bool is_other_noise = is_another(*noise, 1.0);
  double largest = std::max(1.0, *noise);
  for (std::size_t e = 0; e < nominal.effects.size(); ++e) {
    const std::vector<common::EffectParameter>& parameters = problem.catalogue.at(nominal.effects[e].name).parameters;
    for (std::size_t p = 0; p < parameters.size(); ++p) {
      if (p == common::kSize) continue;
      for (const double coordinate : {-kOffTheCentre, kOffTheCentre}) {
        Point start = nominal;
        start.effects[e].values[p] = value_at(parameters[p], coordinate);
        const std::optional<double> there = noise_of(problem, start);
        if (!there || !is_another(*there, *noise)) continue;
        is_other_noise = true;
        largest = std::max(largest, *there);
        starts.push_back(std::move(start));
      }
    }
  }
  if (mean_square(fitted.difference) > kFarAbove * largest) return {};
  if (is_other_noise) starts.push_back(std::move(nominal));
  return starts;
}

void fit_one(Problem& problem, FitResult& fitted) {
  std::vector<Point> starts = starts_of(problem, fitted);
  if (starts.empty()) return;
  starts.push_back(fitted.point);
  std::optional<FitResult> best;
  {
    const UnderOwnNoise under_own_noise(problem, true);
    for (Point& start : starts) {
      FitResult one = fit_from(problem, std::move(start), kRoundsEach);
      if (!best || one.cost < best->cost) best = std::move(one);
    }
    settle(problem, *best, kMoreRounds);
    conclude(problem, *best);
  }
  fitted = std::move(*best);
  fitted.difference = differences(problem, fitted.point);
  renew_columns(problem, fitted);
}

}  // namespace

bool makes_other_noise(const Problem& problem, const Point& point) {
  const std::optional<double> noise = noise_of(problem, point);
  return noise && is_another(*noise, 1.0);
}

void fit_by_own_noise(Problem& problem, std::vector<FitResult>& fits) {
  const auto is_motion = [&](const FitResult& one) { return !one.point.effects.empty() && stochastic_part(problem.catalogue, one.point).empty(); };
  const auto best = std::find_if(fits.begin(), fits.end(), is_motion);
  if (best == fits.end()) return;
  const std::vector<common::EffectInstance> leading = best->point.effects;
  const auto is_part = [&](const FitResult& one) { return one.point.effects.size() == 1 && has_effect(leading, one.point.effects.front().name); };
  for (FitResult& fitted : fits) {
    if (&fitted == &*best || (leading.size() > 1 && is_motion(fitted) && is_part(fitted))) fit_one(problem, fitted);
  }
  std::stable_sort(fits.begin(), fits.end(), [](const FitResult& a, const FitResult& b) { return a.cost < b.cost; });
}

}  // namespace slewlab::diagnosis
