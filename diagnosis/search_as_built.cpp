#include "diagnosis/search_as_built.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <span>
#include <utility>

#include "diagnosis/admit.h"
#include "diagnosis/cause.h"
#include "diagnosis/impacts_of_cause.h"
#include "diagnosis/parameters_alone.h"
#include "diagnosis/recurrence.h"
#include "diagnosis/validate.h"
#include "sim/effects/catalogue.h"

namespace slewlab::diagnosis {

namespace {

constexpr int kRoundsAsBuilt = 3;        // at most, of a fit of the nominal machine built otherwise: its boom cut as its file has it, or what every machine does
constexpr double kOwnLog = 0.5;          // residual variance ratio below that of any sensors' noise; chosen
constexpr double kOwnLogBegun = 0.1;     // the same of a machine whose beginning was fitted, beside coarse counts as well; chosen
constexpr double kBetterAsCut = 20.0;    // fall of the cost, several times what chance lets it fall by
constexpr double kBetterWithAll = 6.0;   // the same for what every machine does: only that it shows is asked

// A fit goes on with the nominal machine built otherwise, and both stay so where that is better.
bool take_built_otherwise(Problem& problem, sim::MachineSettings otherwise, FitResult& fitted, const std::function<bool(const FitResult& other)>& is_better) {
  std::swap(problem.nominal, otherwise);
  FitResult other = fit_again(problem, fitted);
  settle(problem, other, kRoundsAsBuilt);
  if (!is_better(other)) {
    std::swap(problem.nominal, otherwise);
    return false;
  }
  conclude(problem, other);
  fitted = std::move(other);
  return true;
}

// Takes what every machine does into the nominal machine where the fit shows it, and goes on from there. A log that slewlab itself made has it
// not, and small swings do not show it.
bool take_what_shows(Problem& problem, const std::vector<common::EffectInstance>& of_all, FitResult& fitted) {
  if (of_all.empty()) return false;
  sim::MachineSettings with = problem.nominal;
  with.effects.insert(with.effects.end(), of_all.begin(), of_all.end());
  return take_built_otherwise(problem, std::move(with), fitted, [&](const FitResult& other) { return other.cost < fitted.cost - kBetterWithAll; });
}

// What is looked for.
struct Asked {
  const std::vector<std::string>& without;
  const SearchSettings& settings;
};

Searched search_all(Problem& problem, FitResult base, const Asked& asked, const Shows& shows, const Progress& tell) {
  // Corrections of columns after the short steps at the floor of a valley are those of kinks, and beside these effects would seem to show what parameters hide.
  FitResult fresh = base;
  if (base.mean_square <= 1.0) renew_columns(problem, fresh);
  const Projector project(fresh.columns, prior_rows(problem, base.point), data_weight(base.difference, problem.settings));
  const std::vector<common::EffectInstance> starts = catalogue_starts(problem.catalogue, problem.nominal, asked.without, last_moment(problem), problem.thresholds.spell_every,
                                                                      recurring_lengths(problem, base.point, kLengths));
  Screening screening = screen(problem, base, project, starts, within(tell, kScreen));
  Found found = search(problem, base, screening, asked.settings, shows, tell);
  return {std::move(base), std::move(screening), std::move(found), {}, {}};
}

// Takes the boom as the machine's file cuts it where the residual of the fit is smaller with it: a log that slewlab itself made of that file. Without
// sensors' noise what another mesh does shows below the noise as well, where parameters would follow it. Another machine's boom is not cut at all.
bool take_as_cut(Problem& problem, int as_cut, bool is_last, FitResult& fitted) {
  if (problem.nominal.crane.boom.element_count == as_cut) return false;
  sim::MachineSettings with = problem.nominal;
  with.crane.boom.element_count = as_cut;
  return take_built_otherwise(problem, std::move(with), fitted, [&](const FitResult& other) {
    const bool may_be = mean_square(other.difference) < kOwnLog || (is_last && mean_square(fitted.difference) > 1.0);
    return may_be && other.cost < fitted.cost - kBetterAsCut;
  });
}

// Of records that begin on a machine that has moved before: takes the nominal machine as they begin on it, if its residual variance ratio is no more
// than `most`. `fitted` has parameters alone.
void take_beginnings(Problem& problem, const FitResult& fitted, double most, FitResult& nominal_machine) {
  std::optional<FitResult> begun = nominal_with_beginnings(problem, fitted);
  if (begun && begun->mean_square <= most) nominal_machine = std::move(*begun);
}

// Where fits of the nominal machine start: with the beginnings `begun` of its records, where its residual is smaller with them than on a machine that
// has not moved.
FitResult begin_there(Problem& problem, const std::optional<Point>& begun, const FitResult& nominal) {
  if (!begun) return nominal;
  FitResult there = fit_at(problem, *begun);
  return there.mean_square < nominal.mean_square ? there : nominal;
}

// The search on the machine as its records show it to be built: as parameters alone show it, as the best single effect does, or the best fit, and then again.
// `take_out` takes what lies near a cause's impacts out of what is judged; where it did, the search ends.
Searched search_as_shown(Problem& problem, int as_cut, const std::optional<Point>& begun, std::optional<Point> ended_as_cut, FitResult& nominal_machine, std::vector<common::EffectInstance>& of_every_machine, const Asked& asked,
                         const std::function<bool(const Point&)>& take_out, const Progress& tell) {
  std::vector<common::EffectInstance> of_all;
  if (nominal_machine.mean_square > 1.0) of_all = what_every_machine_does(problem.catalogue, problem.nominal, asked.without);
  const auto take_of = [&](bool is_last, FitResult& fitted) {
    const bool is_as_cut = take_as_cut(problem, as_cut, is_last, fitted);
    if (!take_what_shows(problem, of_all, fitted)) return is_as_cut;
    of_every_machine = std::exchange(of_all, {});
    return true;
  };
  const auto shows = [&](FitResult& fitted) {
    if (take_out(fitted.point)) return Shown::judged_elsewhere;
    return take_of(false, fitted) ? Shown::built_otherwise : Shown::nothing;
  };
  const auto search_from = [&](const FitResult& nominal) {
    tell(kFitParameters.from, "fitting the parameters alone");
    FitResult base = fit_parameters_alone(problem, begin_there(problem, begun, nominal), std::exchange(ended_as_cut, std::nullopt));
    take_of(false, base);
    if (nominal_machine.mean_square > 1.0) take_beginnings(problem, base, 1.0, nominal_machine);
    return search_all(problem, std::move(base), asked, shows, tell);
  };
  const int first_count = problem.nominal.crane.boom.element_count;
  Searched searched = search_from(nominal_machine);
  if (searched.found.is_judged_elsewhere) return searched;
  FitResult best = searched.best(problem.catalogue);
  if (take_of(true, best)) searched = search_from(nominal_fit(problem));
  if (problem.nominal.crane.boom.element_count != first_count) nominal_machine = nominal_fit(problem);
  return searched;
}

// Whether each of its effects is known to act: one that has next to no size fits numbers, as the step that it asks for does.
bool acts(const common::EffectCatalogue& catalogue, const FitResult& fit) {
  const std::vector<Size> sizes = sizes_of(catalogue, fit.point.effects, fit.deviation);
  std::size_t first = 0;
  return std::all_of(fit.point.effects.begin(), fit.point.effects.end(), [&](const common::EffectInstance& effect) {
    return !sizes[std::exchange(first, first + effect.values.size()) + common::kSize].may_be_none;
  });
}

// Whether the assumed errors of mesh and step are far larger than the real ones, and hide a gap: the nominal machine stays below them, and another
// one far below that. Errors of rounding and integration are smaller, except behind impacts, and except for what boom and load still do after a
// beginning on a machine that has moved before, which no number describes.
bool is_floor_too_high(const Problem& problem, const FitResult& nominal_machine, const FitResult& best) {
  constexpr double kHidden = 0.01, kFarBelow = 0.1;
  const auto is_free = [](const Whitening& whitening) { return judged_share(whitening) >= kFreeOfImpacts; };
  if (!all_begin_unmoved(problem) || !acts(problem.catalogue, best)) return false;
  return std::all_of(problem.whitening.begin(), problem.whitening.end(), is_free) && nominal_machine.mean_square > kHidden && nominal_machine.mean_square <= 1.0 && best.mean_square < kFarBelow * nominal_machine.mean_square;
}

}  // namespace

const FitResult& Searched::best(const common::EffectCatalogue& catalogue) const {
  const FitResult* best = &found.nothing;
  for (const FitResult& one : found.fits) {
    const bool is_motion = stochastic_part(catalogue, one.point).empty();
    if (is_motion && one.cost < best->cost) best = &one;
  }
  return *best;
}

Searched search_as_built(Problem& problem, WhiteningSettings& whitening, const std::vector<std::string>& without, const SearchSettings& settings, std::vector<std::string>& remarks,
                         const Progress& tell) {
  constexpr double kLeastShown = 1e-4;  // of the floor's square; chosen: a smaller residual may be a fit's own
  constexpr int kMostTakenOut = 2;      // times; chosen
  const sim::MachineSettings admitted = problem.nominal;
  const int as_cut = admitted.crane.boom.element_count;
  FitResult nominal_machine;
  std::vector<common::EffectInstance> of_every_machine;
  int taken_out = 0;
  const auto take_out = [&](const Point& cause) {
    if (taken_out == kMostTakenOut) return false;
    const double share = take_out_impacts(problem, admitted, whitening, cause);
    if (share <= 0.0) return false;
    ++taken_out;
    remarks.push_back(fmt::format("the gears of a machine with a smaller residual than the nominal one strike where those of the nominal machine do not: {:.0f} % of the records lie near these impacts and are not judged either", 100.0 * share));
    return true;
  };
  std::optional<Point> begun;
  bool is_beginning_asked = false;
  const auto ask_for_the_beginning = [&] {
    if (std::exchange(is_beginning_asked, true)) return;
    const std::optional<FitResult> found = begun_before_impacts(problem, admitted, whitening);
    if (!found || found->mean_square > kNoiseAlone) return;
    begun = found->point;
    if (take_out(*begun)) nominal_machine = nominal_fit(problem);
  };
  const auto search_here = [&] {
    problem.nominal = admitted;
    of_every_machine.clear();
    std::optional<Point> ended_as_cut;  // the fit of the parameters alone
    nominal_machine = nominal_fit(problem);
    const auto may_be_cut_finer = [&] { return nominal_machine.mean_square > 1.0 && as_cut > 0 && as_cut < kBoomElements; };
    if (nominal_machine.mean_square > 1.0 && !all_begin_unmoved(problem)) {
      ask_for_the_beginning();
      if (may_be_cut_finer()) {
        const FitResult as_cut_alone = fit_parameters_alone(problem, begin_there(problem, begun, nominal_machine));
        take_beginnings(problem, as_cut_alone, kOwnLogBegun, nominal_machine);
        ended_as_cut = as_cut_alone.point;
      }
    }
    if (may_be_cut_finer()) {
      problem.nominal = with_boom_elements(problem.nominal, kBoomElements);
      nominal_machine = nominal_fit(problem);
    }
    return search_as_shown(problem, as_cut, begun, std::move(ended_as_cut), nominal_machine, of_every_machine, {without, settings}, take_out, tell);
  };
  const auto search_judged = [&] {
    while (true) {
      Searched searched = search_here();
      if (searched.found.is_judged_elsewhere || take_out(searched.best(problem.catalogue).point)) continue;
      searched.nominal_machine = std::move(nominal_machine);
      searched.of_every_machine = std::move(of_every_machine);
      return searched;
    }
  };
  Searched searched = search_judged();
  const FitResult& best = searched.best(problem.catalogue);
  if (!is_floor_too_high(problem, searched.nominal_machine, best)) return searched;
  const double shown = std::sqrt(std::max(kLeastShown, best.mean_square));
  const int taken_out_before = taken_out;
  const WhiteningSettings judged_before = whitening;
  const sim::MachineSettings built_before = problem.nominal;
  whitening.discrepancy_share *= shown;
  problem.nominal = admitted;
  whiten_again(problem, whitening);
  Searched below = search_judged();
  if (acts(problem.catalogue, below.best(problem.catalogue))) {
    remarks.push_back(fmt::format("a machine was found that the records follow to {:.2g} of what mesh and step are taken to make wrong: judged by its residual", shown));
    return below;
  }
  whitening = judged_before;
  problem.nominal = admitted;
  whiten_again(problem, whitening);
  if (taken_out != taken_out_before) return search_judged();
  problem.nominal = built_before;
  return searched;
}

}  // namespace slewlab::diagnosis
