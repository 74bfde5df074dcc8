#include "diagnosis/own_noise_fit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "diagnosis/own_noise.h"
#include "diagnosis/validate.h"

namespace slewlab::diagnosis {

namespace {

constexpr std::size_t kSingles = 2, kPairs = 1;  // that are fitted by their own noise; chosen
constexpr int kRoundsEach = 12;                  // at most, from each start; chosen
constexpr double kOffTheCentre = 1.5;            // deviations of its prior, by which a shape is moved; chosen

bool is_another(double noise, double than) { return std::fabs(noise - than) > kNoise; }

// With nominal parameters: its effects as they are, and with each of the shapes that change the noise moved to either side of its centre. None where neither changes it.
std::vector<Point> starts_of(const Problem& problem, const FitResult& fitted) {
  Point nominal = fitted.point;
  std::fill(nominal.nuisance.begin(), nominal.nuisance.end(), 0.0);
  const double noise = mean_square_of_noise(problem, nominal);
  bool is_other_noise = is_another(noise, 1.0);
  std::vector<Point> starts;
  for (std::size_t e = 0; e < nominal.effects.size(); ++e) {
    const std::vector<common::EffectParameter>& parameters = problem.catalogue.at(nominal.effects[e].name).parameters;
    for (std::size_t p = 0; p < parameters.size(); ++p) {
      if (p == common::kSize) continue;
      for (const double coordinate : {-kOffTheCentre, kOffTheCentre}) {
        Point start = nominal;
        start.effects[e].values[p] = value_at(parameters[p], coordinate);
        if (!is_another(mean_square_of_noise(problem, start), noise)) continue;
        is_other_noise = true;
        starts.push_back(std::move(start));
      }
    }
  }
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
    conclude(problem, *best);
  }
  fitted = std::move(*best);
  fitted.difference = differences(problem, fitted.point);
  renew_columns(problem, fitted);
}

}  // namespace

bool makes_other_noise(const Problem& problem, const Point& point) { return is_another(mean_square_of_noise(problem, point), 1.0); }

void fit_by_own_noise(Problem& problem, std::vector<FitResult>& fits) {
  std::size_t singles = 0, pairs = 0;
  for (FitResult& fitted : fits) {
    if (!stochastic_part(problem.catalogue, fitted.point).empty()) continue;
    const std::size_t effects = fitted.point.effects.size();
    if (effects == 1 ? singles++ < kSingles : effects == 2 && pairs++ < kPairs) fit_one(problem, fitted);
  }
  std::stable_sort(fits.begin(), fits.end(), [](const FitResult& a, const FitResult& b) { return a.cost < b.cost; });
}

}  // namespace slewlab::diagnosis
