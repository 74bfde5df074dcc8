#include "diagnosis/spell_times.h"

#include <algorithm>
#include <utility>

#include "diagnosis/screen.h"

namespace slewlab::diagnosis {

namespace {

constexpr int kSteps = 12;            // earlier and later
constexpr double kStep = 0.15;        // of the characteristic time: less than a quarter of the lowest mode's period
constexpr std::size_t kFitted = 2;    // of the times
constexpr int kLooks = 4;             // at most
constexpr int kRounds = 10;           // of a fit, at most
constexpr double kMuch = 6.0;         // fall of the cost for which it is looked again

// The effect with its details as they are, and each of them at either end of its usual range.
std::vector<common::EffectInstance> with_details(const common::EffectAbout& about, const common::EffectInstance& effect) {
  std::vector<common::EffectInstance> all{effect};
  for (std::size_t p = 0; p < about.parameters.size(); ++p) {
    const common::EffectParameter& parameter = about.parameters[p];
    if (!parameter.detail) continue;
    const double centre = to_coordinate(parameter, parameter.typical);
    for (const double deviation : {-1.0, 1.0}) {
      common::EffectInstance other = effect;
      other.values[p] = value_at(parameter, centre + deviation);
      all.push_back(std::move(other));
    }
  }
  return all;
}

}  // namespace

std::vector<common::EffectInstance> other_times(const common::EffectAbout& about, const common::EffectInstance& effect, double time_step) {
  const std::size_t begin = index_of(about, about.spell->begin), duration = index_of(about, about.spell->duration);
  const auto is_within = [&](const common::EffectInstance& one, std::size_t p) {
    return one.values[p] >= about.parameters[p].lower && one.values[p] <= about.parameters[p].upper;
  };
  std::vector<common::EffectInstance> times;
  for (const common::EffectInstance& as_it_is : with_details(about, effect)) {
    for (int step = -kSteps; step <= kSteps; ++step) {
      common::EffectInstance other_begin = as_it_is, other_end = as_it_is;
      other_begin.values[begin] += step * time_step;
      other_begin.values[duration] -= step * time_step;
      other_end.values[duration] += step * time_step;
      for (const common::EffectInstance& one : {other_begin, other_end}) {
        if (step != 0 && is_within(one, begin) && is_within(one, duration)) times.push_back(one);
      }
    }
  }
  return times;
}

void look_for_other_times(Problem& problem, FitResult& fitted) {
  const auto lasts_for_a_spell = [&](const common::EffectInstance& effect) { return problem.catalogue.at(effect.name).spell.has_value(); };
  const std::vector<common::EffectInstance>& effects = fitted.point.effects;
  const auto which = std::find_if(effects.begin(), effects.end(), lasts_for_a_spell) - effects.begin();
  if (which == static_cast<std::ptrdiff_t>(effects.size())) return;
  const common::EffectAbout& about = problem.catalogue.at(effects[static_cast<std::size_t>(which)].name);
  for (int look = 0; look < kLooks; ++look) {
    const std::vector<common::EffectInstance> times = other_times(about, fitted.point.effects[static_cast<std::size_t>(which)], kStep * problem.thresholds.time);
    if (times.empty()) return;
    Point rest = fitted.point;
    rest.effects.erase(rest.effects.begin() + which);
    const FitResult ground = common_ground(problem, fitted, rest);
    Screening there = screen(problem, ground, projector_of(problem, ground), times, [](double, const std::string&) {});
    std::stable_sort(there.tried.begin(), there.tried.end(), [](const Screened& a, const Screened& b) { return a.left < b.left; });
    const double before = fitted.cost;
    for (std::size_t k = 0; k < std::min(kFitted, there.tried.size()); ++k) {
      Point start = with_amount(problem.catalogue, ground.point, there.tried[k], there.tried[k].amount);
      std::rotate(start.effects.begin() + which, start.effects.end() - 1, start.effects.end());
      FitResult other = fit(problem, fitted.columns.leftCols(static_cast<Eigen::Index>(start.nuisance.size())), start);
      settle(problem, other, kRounds);
      if (other.cost < fitted.cost) fitted = std::move(other);
    }
    if (fitted.cost > before - kMuch) return;
  }
}

}  // namespace slewlab::diagnosis
