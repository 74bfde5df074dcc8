#include "diagnosis/spell_times.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "diagnosis/screen.h"

namespace slewlab::diagnosis {

namespace {

constexpr int kParts = 16;            // of the longest record, at the ends of which it may begin and end
constexpr std::array<double, 3> kSizes{2.0, 4.0, 8.0};  // times the typical one
constexpr double kSlow = 2.0;         // deviations of a detail above its typical value
// Of the characteristic time, earlier and later: less than a quarter of the lowest mode's period apart, and then where it may be that strikes nothing.
constexpr std::array<double, 12> kSteps{0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0, 3.0, 4.5, 6.0, 8.0};
constexpr std::size_t kFitted = 3;    // of the times
constexpr int kLooks = 3;             // at most
constexpr int kRounds = 3;            // of a fit, at most
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

bool is_within(const common::EffectAbout& about, const common::EffectInstance& effect, std::size_t p) {
  return effect.values[p] >= about.parameters[p].lower && effect.values[p] <= about.parameters[p].upper;
}

// Those that promise most, each at another time.
std::vector<const Screened*> best_times(const common::EffectAbout& about, const std::vector<Screened>& tried) {
  const SpellPlaces spell = places_of(about);
  std::vector<const Screened*> ranked, best;
  for (const Screened& one : tried) ranked.push_back(&one);
  std::stable_sort(ranked.begin(), ranked.end(), [](const Screened* a, const Screened* b) { return a->left < b->left; });
  for (const Screened* one : ranked) {
    const auto is_then = [&](const Screened* other) {
      return one->start.values[spell.begin] == other->start.values[spell.begin] && one->start.values[spell.duration] == other->start.values[spell.duration];
    };
    if (std::none_of(best.begin(), best.end(), is_then)) best.push_back(one);
    if (best.size() == kFitted) break;
  }
  return best;
}

}  // namespace

std::vector<common::EffectInstance> other_times(const common::EffectAbout& about, const common::EffectInstance& effect, double time) {
  const SpellPlaces spell = places_of(about);
  std::vector<common::EffectInstance> times;
  for (const common::EffectInstance& as_it_is : with_details(about, effect)) {
    for (const double step : kSteps) {
      for (const double by : {-step * time, step * time}) {
        common::EffectInstance other_begin = as_it_is, other_end = as_it_is;
        other_begin.values[spell.begin] += by;
        other_begin.values[spell.duration] -= by;
        other_end.values[spell.duration] += by;
        for (const common::EffectInstance& one : {other_begin, other_end}) {
          if (is_within(about, one, spell.begin) && is_within(about, one, spell.duration)) times.push_back(one);
        }
      }
    }
  }
  return times;
}

std::vector<common::EffectInstance> all_times(const common::EffectAbout& about, double record_time) {
  const SpellPlaces spell = places_of(about);
  const common::EffectParameter& size = about.parameters[common::kSize];
  const double absent = size.absent.value_or(0.0), part = record_time / kParts;
  // With ramps too slow to strike the structure, which goes by parts of a second.
  common::EffectInstance slow = common::typical_instance(about);
  for (std::size_t p = 0; p < about.parameters.size(); ++p) {
    const common::EffectParameter& parameter = about.parameters[p];
    if (parameter.detail) slow.values[p] = value_at(parameter, to_coordinate(parameter, parameter.typical) + kSlow);
  }
  std::vector<common::EffectInstance> times;
  for (int first = 0; first < kParts; ++first) {
    for (int last = first + 1; last <= kParts; ++last) {
      for (const double share : kSizes) {
        for (const double sign : {1.0, -1.0}) {
          common::EffectInstance one = slow;
          one.values[spell.begin] = first * part;
          one.values[spell.duration] = (last - first) * part;
          one.values[common::kSize] = std::clamp(absent + sign * share * (size.typical - absent), size.lower, size.upper);
          if (is_within(about, one, spell.begin) && one.values[spell.duration] >= 2.0 * slow.values[spell.fade]) times.push_back(std::move(one));
        }
      }
    }
  }
  return times;
}

void look_for_other_times(Problem& problem, FitResult& fitted) {
  const auto lasts_for_a_spell = [&](const common::EffectInstance& effect) { return problem.catalogue.at(effect.name).spell.has_value(); };
  const auto which = std::find_if(fitted.point.effects.begin(), fitted.point.effects.end(), lasts_for_a_spell) - fitted.point.effects.begin();
  if (which == static_cast<std::ptrdiff_t>(fitted.point.effects.size())) return;
  const common::EffectAbout& about = problem.catalogue.at(fitted.point.effects[static_cast<std::size_t>(which)].name);
  // The best of the fits from the times that promise most, on the machine of `from` without the law or on the nominal one.
  const auto look = [&](const FitResult& from, const std::vector<common::EffectInstance>& times, bool on_the_nominal_machine) {
    Point rest = from.point;
    rest.effects.erase(rest.effects.begin() + which);
    FitResult ground = common_ground(problem, from, rest);
    if (on_the_nominal_machine) {
      std::fill_n(ground.point.nuisance.begin(), problem.nuisances.common_count(), 0.0);
      ground.difference = differences(problem, ground.point);
    }
    const Screening there = screen(problem, ground, projector_of(problem, ground), times, [](double, const std::string&) {});
    FitResult best = from;
    best.cost = std::numeric_limits<double>::infinity();
    for (const Screened* promising : best_times(about, there.tried)) {
      Point start = with_amount(problem.catalogue, ground.point, *promising, promising->amount);
      std::rotate(start.effects.begin() + which, start.effects.end() - 1, start.effects.end());
      FitResult other = fit(problem, from.columns.leftCols(static_cast<Eigen::Index>(start.nuisance.size())), start);
      settle_from_afar(problem, other, 1.0, kRounds);
      settle(problem, other, kRounds, best.cost);
      if (other.cost < best.cost) best = std::move(other);
    }
    return best;
  };
  // From there on, while it comes on by much.
  const auto go_on = [&](FitResult& one) {
    for (int looks = 0; looks < kLooks && mean_square(one.difference) > kNoiseAlone; ++looks) {
      FitResult other = look(one, other_times(about, one.point.effects[static_cast<std::size_t>(which)], problem.thresholds.time), false);
      const bool came_on_by_much = other.cost < one.cost - kMuch;
      if (other.cost < one.cost) one = std::move(other);
      if (!came_on_by_much) return;
    }
  };
  FitResult elsewhere = look(fitted, all_times(about, last_moment(problem)), true);
  go_on(elsewhere);
  if (mean_square(elsewhere.difference) > kNoiseAlone) go_on(fitted);
  if (elsewhere.cost < fitted.cost) fitted = std::move(elsewhere);
}

}  // namespace slewlab::diagnosis
