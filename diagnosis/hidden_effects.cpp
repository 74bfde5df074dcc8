#include "diagnosis/hidden_effects.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "diagnosis/coordinates.h"

namespace slewlab::diagnosis {

namespace {

// Student's t of 2 degrees of freedom with the scale of nuisance.h's effect_prior(): density in proportion to (1 + x^2 / 3)^(-3/2).
double distribution(double x) { return 0.5 * (1.0 + x / std::sqrt(3.0 + x * x)); }

}  // namespace

double told_from(int effect_count, const EvidenceSettings& settings) {
  const double effects = std::max(1, effect_count);
  const double asked = settings.effect_cost + 2.0 * settings.temper * std::log(settings.prior_nothing * effects / settings.prior_single);
  const auto misfit = [&](double c) { return MisfitCost(settings, c)(c); };
  double from = 0.0, to = 1.0;
  while (misfit(to) < asked) to *= 2.0;
  for (int k = 0; k < 50; ++k) {
    const double middle = 0.5 * (from + to);
    (misfit(middle) < asked ? from : to) = middle;
  }
  return to;
}

double share_hidden(const common::EffectParameter& size, double start, double square, double needed, double independent_share) {
  const double amount = std::sqrt(needed / std::max(independent_share * square, 1e-300));  // of the start, that is hidden
  const bool is_endless = size.absent && !std::isfinite(*size.absent);
  const double absent = size.absent && !is_endless ? *size.absent : size.lower;
  const double reach = std::min(amount, 1e6) * std::fabs(start - absent);
  const double low = is_endless ? start / std::max(amount, 1e-6) : absent - reach, high = is_endless ? size.upper : absent + reach;
  const auto share_below = [&](double value) { return distribution(to_coordinate(size, std::clamp(value, size.lower, size.upper))); };
  const double all = share_below(size.upper) - share_below(size.lower);
  return all > 0.0 ? std::clamp((share_below(high) - share_below(low)) / all, 0.0, 1.0) : 1.0;
}

Hidden hidden_effects(const common::EffectCatalogue& catalogue, std::span<const Screened> tried, int effect_count, const EvidenceSettings& settings) {
  const double c = told_from(effect_count, settings);
  struct Sum {
    double hidden = 0.0, count = 0.0;
  };
  std::map<std::string, Sum> by_effect;
  for (const Screened& screened : tried) {
    if (!std::isfinite(screened.visibility)) continue;  // a machine that is none tells nothing
    const common::EffectParameter& size = catalogue.at(screened.start.name).parameters[common::kSize];
    Sum& sum = by_effect[screened.start.name];
    sum.hidden += share_hidden(size, screened.start.values[common::kSize], screened.visibility, c, settings.independent_share);
    sum.count += 1.0;
  }
  Hidden result;
  double mean = 0.0;
  for (const auto& [name, sum] : by_effect) {
    result.effects.emplace_back(name, sum.hidden / sum.count);
    mean += result.effects.back().second / static_cast<double>(by_effect.size());
  }
  std::stable_sort(result.effects.begin(), result.effects.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  result.odds = (settings.prior_single * mean + settings.prior_pair * mean * mean) / settings.prior_nothing;
  return result;
}

}  // namespace slewlab::diagnosis
