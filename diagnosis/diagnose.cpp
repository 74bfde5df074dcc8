#include "diagnosis/diagnose.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <set>
#include <span>
#include <utility>

#include "controller/effects/catalogue.h"
#include "diagnosis/admit.h"
#include "diagnosis/controller_loop.h"
#include "diagnosis/discrepancy.h"
#include "diagnosis/hidden_effects.h"
#include "diagnosis/impacts_of_cause.h"
#include "diagnosis/model_step.h"
#include "diagnosis/own_noise.h"
#include "diagnosis/recurrence.h"
#include "diagnosis/stochastic.h"
#include "diagnosis/screen.h"
#include "diagnosis/unknown_law.h"
#include "sim/effects/catalogue.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kFarOff = 2.6;        // [standard deviations] of a parameter, beyond which it may be another crane
constexpr double kMostMachines = 1e6;   // that are spoken of: the chance is not known better
constexpr double kWorthASwing = 2e-3;  // [rad] of the load at a record's beginning: a five-hundredth of the rope's length
constexpr std::size_t kMoments = 8;    // that are named
constexpr double kUnknownBelowNoise = 0.4;  // of the probability that no known effect is missing, where parameters leave noise alone and no law was fitted
constexpr double kDoubtful = 0.4;  // share of its probability that a doubted cause loses: it still leads, and is not sure
// Of what is "unknown", by how often it was on machines that no score uses; the rest are known effects whose law is another one than the catalogue's.
constexpr double kOutsideTheCatalogue = 0.7;
constexpr double kOtherLawTemper = 5.0;  // chosen: by which the evidence among these counts less
// How sure a lead is at most, by how often it was right on machines that no score uses (docs/history/diagnosis.md): where one effect is the answer, parameters
// or that effect hid a second one so often; where the answer leaves more than the noise can be off by, it was another one so often; and so likely is
// something small where parameters alone leave that.
constexpr double kHiddenBeside = 0.12, kAboveTheNoise = 0.25, kSmallBesideNothing = 0.25;
constexpr double kClearLead = 0.6;  // probability, beyond which no other answer can come to lead by that
constexpr int kRoundsAsBuilt = 3;        // at most, of a fit of the nominal machine built otherwise: its boom cut as its file has it, or what every machine does
constexpr double kOwnLog = 0.5;          // mean square that no sensors' noise leaves as low; chosen
constexpr double kOwnLogBegun = 0.1;     // the same of a machine whose beginning was fitted, beside coarse counts as well; chosen
constexpr double kBetterAsCut = 20.0;    // fall of the cost, several times what chance lets it fall by
constexpr double kBetterWithAll = 6.0;   // the same for what every machine does: only that it shows is asked
constexpr int kMostValidated = 4;      // causes that are asked to predict before none is believed
// On a log of the wire both sides are exact; a thousandth leaves room for logs that were rounded.
constexpr double kSameTorque = 1e-3;
constexpr double kOfNoise = 1.5;  // of the deviation of torques that were measured or rounded; the integrals are told by one of them
// Occam's factor of one number, beside which an effect must tell: of one that is known to a twelfth of its prior.
constexpr double kOccam = 5.0;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Whether the nominal controller answers what was recorded.
void replay(const Problem& problem, const controller::ControllerSettings& controller, Diagnosis& diagnosis) {
  for (const Record& record : problem.records) {
    check_replayable(record);
    diagnosis.controller_replay.push_back(replay_controller(record, controller));
    const ControllerReplay& replay = diagnosis.controller_replay.back();
    diagnosis.has_controller |= !replay.difference.empty();
    if (replay.difference.empty()) {
      diagnosis.remarks.push_back(fmt::format("{}: begins in motion or just behind one, and the joystick never stands still for as long as a ramp may take; what the controller "
                                              "knew is not in the record, and its answers are not compared", record.name));
      continue;
    }
    if (replay.difference_rms > std::hypot(kSameTorque * replay.torque_rms, kOfNoise * std::sqrt(record.torque_noise))) diagnosis.controller_differs = true;
  }
}

struct Searched {
  FitResult base;  // parameters alone
  Screening screening;
  Found found;

  const FitResult& best(const common::EffectCatalogue& catalogue) const {
    const FitResult* best = &found.nothing;
    for (const FitResult& one : found.fits) {
      const bool is_motion = stochastic_part(catalogue, one.point).empty();
      if (is_motion && one.cost < best->cost) best = &one;
    }
    return *best;
  }
};

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

// What every machine does, as it is; nothing of what the file has or the catalogue lacks, or the user left out.
std::vector<common::EffectInstance> what_all_do(const Problem& problem, std::span<const std::string> without) {
  std::vector<common::EffectInstance> all;
  for (const common::EffectAbout& about : problem.catalogue.effects) {
    const bool is_left_out = std::find(without.begin(), without.end(), about.name) != without.end();
    if (about.of_every_machine && !is_left_out && !has_effect(problem.nominal.effects, about.name)) all.push_back(common::typical_instance(about));
  }
  return all;
}

// Takes what every machine does into the nominal machine where the fit shows it, and goes on from there. A log that slewlab itself made has it
// not, and small swings do not show it.
bool take_what_shows(Problem& problem, const std::vector<common::EffectInstance>& of_all, FitResult& fitted) {
  if (of_all.empty()) return false;
  sim::MachineSettings with = problem.nominal;
  with.effects.insert(with.effects.end(), of_all.begin(), of_all.end());
  return take_built_otherwise(problem, std::move(with), fitted, [&](const FitResult& other) { return other.cost < fitted.cost - kBetterWithAll; });
}

Searched search_all(Problem& problem, FitResult base, const DiagnosisSettings& settings, const Shows& shows, const Progress& tell) {
  const Projector project(base.columns, prior_rows(problem, base.point), data_weight(base.difference, settings.fit));
  const std::vector<common::EffectInstance> starts = catalogue_starts(problem.catalogue, problem.nominal, settings.without, last_moment(problem), problem.thresholds.spell_every,
                                                                      recurring_lengths(problem, base.point, kLengths));
  Screening screening = screen(problem, base, project, starts, within(tell, kScreen));
  Found found = search(problem, base, screening, settings.search, shows, tell);
  return {std::move(base), std::move(screening), std::move(found)};
}

// Takes the boom as the machine's file cuts it where the fit leaves less on it: a log that slewlab itself made of that file. Without sensors' noise what another mesh does shows
// below the noise as well, where parameters would follow it. Another machine's boom is not cut at all.
bool take_as_cut(Problem& problem, int as_cut, bool is_last, FitResult& fitted) {
  if (problem.nominal.crane.boom.element_count == as_cut) return false;
  sim::MachineSettings with = problem.nominal;
  with.crane.boom.element_count = as_cut;
  return take_built_otherwise(problem, std::move(with), fitted, [&](const FitResult& other) {
    const bool may_be = mean_square(other.difference) < kOwnLog || (is_last && mean_square(fitted.difference) > 1.0);
    return may_be && other.cost < fitted.cost - kBetterAsCut;
  });
}

// Of records that begin on a machine that has moved before the nominal machine as they begin on it, if that leaves no more than `most`; `fitted` has parameters alone.
void take_beginnings(Problem& problem, const FitResult& fitted, double most, FitResult& nominal_machine) {
  std::optional<FitResult> begun = nominal_with_beginnings(problem, fitted);
  if (begun && begun->mean_square <= most) nominal_machine = std::move(*begun);
}

// The search on the machine as its records show it to be built: as parameters alone show it, as the best single effect does, or the best fit, and then again.
// `take_out` takes what lies near a cause's impacts out of what is judged; where it did, the search ends.
Searched search_as_built(Problem& problem, int as_cut, FitResult& nominal_machine, const DiagnosisSettings& settings, const std::function<bool(const Point&)>& take_out, Diagnosis& diagnosis,
                         const Progress& tell) {
  std::vector<common::EffectInstance> of_all;
  if (nominal_machine.mean_square > 1.0) of_all = what_all_do(problem, settings.without);
  const auto take_of = [&](bool is_last, FitResult& fitted) {
    const bool is_as_cut = take_as_cut(problem, as_cut, is_last, fitted);
    if (!take_what_shows(problem, of_all, fitted)) return is_as_cut;
    diagnosis.of_every_machine = std::exchange(of_all, {});
    return true;
  };
  const auto shows = [&](FitResult& fitted) {
    if (take_out(fitted.point)) return Shown::judged_elsewhere;
    return take_of(false, fitted) ? Shown::built_otherwise : Shown::nothing;
  };
  const auto search_from = [&](const FitResult& start) {
    tell(kFitParameters.from, "fitting the parameters alone");
    FitResult base = fit_nuisances(problem, start);
    take_of(false, base);
    if (nominal_machine.mean_square > 1.0) take_beginnings(problem, base, 1.0, nominal_machine);
    return search_all(problem, std::move(base), settings, shows, tell);
  };
  const int first_count = problem.nominal.crane.boom.element_count;
  Searched searched = search_from(nominal_machine);
  if (searched.found.is_judged_elsewhere) return searched;
  FitResult best = searched.best(problem.catalogue);
  if (take_of(true, best)) searched = search_from(nominal_fit(problem));
  if (problem.nominal.crane.boom.element_count != first_count) nominal_machine = nominal_fit(problem);
  return searched;
}

// Whether what mesh and step were taken to make wrong is far more than they do, and hides a gap: the nominal machine stays below it, and another one far below that. What numbers
// and integration leave is less, but for what goes on behind impacts, and for what a beginning on a machine that has moved before leaves of boom and load that no number describes.
bool is_floor_too_high(const Problem& problem, const FitResult& nominal_machine, const FitResult& best) {
  constexpr double kHidden = 0.01, kFarBelow = 0.1;
  const auto is_free = [](const Whitening& whitening) { return judged_share(whitening) >= kFreeOfImpacts; };
  if (!all_begin_unmoved(problem)) return false;
  return std::all_of(problem.whitening.begin(), problem.whitening.end(), is_free) && nominal_machine.mean_square > kHidden && nominal_machine.mean_square <= 1.0 && best.mean_square < kFarBelow * nominal_machine.mean_square;
}

// The search, on what is left to be judged where a cause has impacts of its own, and once more where the best fit shows that mesh and step are better than they were taken for, as those of slewlab's own logs are: with the
// floor that it shows.
Searched search_to_the_floor(Problem& problem, WhiteningSettings& whitening, FitResult& nominal_machine, const DiagnosisSettings& settings, Diagnosis& diagnosis, const Progress& tell) {
  constexpr double kLeastShown = 1e-4;  // of the floor's square; chosen: what is left below may be a fit's own
  constexpr int kMostTakenOut = 2;      // times; chosen
  const sim::MachineSettings admitted = problem.nominal;
  const int as_cut = admitted.crane.boom.element_count;
  int taken_out = 0;
  const auto take_out = [&](const Point& cause) {
    if (taken_out == kMostTakenOut) return false;
    const double share = take_out_impacts(problem, admitted, whitening, cause);
    if (share <= 0.0) return false;
    ++taken_out;
    diagnosis.remarks.push_back(fmt::format("a machine that leaves less than the nominal one lets its gears strike where that does not: {:.0f} % of the records lie near that and are not judged either", 100.0 * share));
    return true;
  };
  const auto search_here = [&] {
    problem.nominal = admitted;
    diagnosis.of_every_machine.clear();
    nominal_machine = nominal_fit(problem);
    const auto may_be_cut_finer = [&] { return nominal_machine.mean_square > 1.0 && as_cut > 0 && as_cut < kBoomElements; };
    if (may_be_cut_finer() && !all_begin_unmoved(problem)) take_beginnings(problem, fit_nuisances(problem, nominal_machine), kOwnLogBegun, nominal_machine);
    if (may_be_cut_finer()) {
      problem.nominal = with_boom_elements(problem.nominal, kBoomElements);
      nominal_machine = nominal_fit(problem);
    }
    return search_as_built(problem, as_cut, nominal_machine, settings, take_out, diagnosis, tell);
  };
  const auto search_judged = [&] {
    while (true) {
      Searched searched = search_here();
      if (!searched.found.is_judged_elsewhere && !take_out(searched.best(problem.catalogue).point)) return searched;
    }
  };
  Searched searched = search_judged();
  const FitResult& best = searched.best(problem.catalogue);
  if (!is_floor_too_high(problem, nominal_machine, best)) return searched;
  const double shown = std::sqrt(std::max(kLeastShown, best.mean_square));
  whitening.discrepancy_share *= shown;
  problem.nominal = admitted;
  whiten_again(problem, whitening);
  diagnosis.remarks.push_back(fmt::format("a machine was found that the records follow to {:.2g} of what mesh and step are taken to make wrong: judged by what it leaves", shown));
  return search_judged();
}

// Effects of which these records could not name even the most visible size.
std::vector<std::string> not_excited(const Screening& screening, const EvidenceSettings& evidence) {
  const double visible = (told_from(static_cast<int>(screening.names.size()), evidence) + kOccam) / evidence.independent_share;
  std::vector<std::string> names;
  for (const auto& [name, square] : screening.visibility) {
    if (square < visible) names.push_back(name);
  }
  return names;
}

// From fits to causes with probabilities, in the order of the fits, that without effects first.
struct Weighed {
  std::vector<Cause> causes;
  Probabilities probabilities;

  // The fit of the likeliest cause that has effects; nothing where an unknown one is likelier.
  const FitResult* answer(const std::vector<FitResult>& fits) const {
    const auto likeliest = std::max_element(probabilities.candidate.begin() + 1, probabilities.candidate.end());
    if (likeliest == probabilities.candidate.end() || probabilities.unknown >= *likeliest) return nullptr;
    return &fits[static_cast<std::size_t>(likeliest - probabilities.candidate.begin() - 1)];
  }
};

// What a fit leaves by what the sensors' noise makes of its machine. Differences that have been divided already by a stochastic effect's power have the less noise beside it, the more of that power there is: they are not
// allowed more of it than in the nominal machine.
Leaving by_own_machine(const Problem& problem, const FitResult& result, double discrepancy_count, const std::optional<ControllerLoop>& loop) {
  const Point rest = without_stochastic(problem.catalogue, result.point);
  const double share = problem.settings.independent_share;
  const double by_loop = loop ? share * loss_by_loop(problem, *loop, rest) : 0.0;
  if (rest.effects.size() < result.point.effects.size()) {
    return {result.excess + by_loop + share * (square_by_less_noise(problem, rest, result.difference, discrepancy_count) - result.difference.squaredNorm()), {}, {}};
  }
  ByOwnNoise own = by_own_noise(problem, rest, result.difference, result.columns, discrepancy_count);
  return {by_loop + share * (own.square - static_cast<double>(result.difference.size())), std::move(own.gram), std::move(own.slope)};
}

// Parameters that shape effects and were moved to a bound at which their priors have no centre: of one that has, half of the prior lies beyond as well. A size there is doubted
// for itself.
int count_at_bounds(const common::EffectCatalogue& catalogue, const Point& point) {
  int count = 0;
  for (const common::EffectInstance& effect : point.effects) {
    const std::vector<common::EffectParameter>& parameters = catalogue.at(effect.name).parameters;
    for (std::size_t p = 0; p < parameters.size(); ++p) {
      if (p != common::kSize && is_at_a_bound(parameters[p], effect.values[p]) && to_coordinate(parameters[p], effect.values[p]) != 0.0) ++count;
    }
  }
  return count;
}

// Hypotheses of the fits and what they are compared by; fits in the order of `found`, that without effects apart.
struct Compared {
  std::vector<Leaving> of_fits;
  Leaving of_nothing;
  MisfitCost misfit_cost;
  double floor = 0.0;
  EvidenceSettings evidence;
};

// Beside which of them an unknown law is asked for: the best single effect, and those that lead together.
std::vector<std::size_t> fits_to_ask_beside(const Problem& problem, const std::vector<FitResult>& fits, const FitResult* answer) {
  std::vector<std::size_t> asked;
  bool has_best = false;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    const Point& point = fits[i].point;
    if (point.effects.size() != 1 || !stochastic_part(problem.catalogue, point).empty()) continue;
    const bool leads = answer != nullptr && has_effect(answer->point.effects, point.effects.front().name);
    if (!has_best || leads) asked.push_back(i);
    has_best = true;
  }
  return asked;
}

// With laws that are in no catalogue, alone or beside an effect, as hypotheses of their own: their probability is that of an unknown cause, or of the effect, beside which something is left.
void weigh_unknown_laws(Problem& problem, const Found& found, const SmoothTorques& smooth, const Compared& compared, std::size_t effect_count, std::vector<Candidate> candidates, Weighed& weighed) {
  constexpr double kSmooth = 0.5;    // share of unknown laws that are such functions; chosen
  constexpr double kVariables = 4.0;
  const EvidenceSettings& evidence = compared.evidence;
  const std::vector<std::size_t> beside = fits_to_ask_beside(problem, found.fits, weighed.answer(found.fits));
  std::vector<std::vector<UnknownLaw>> laws(beside.size() + 1);
  share_out(problem, laws.size(), [&](std::size_t k) {
    const FitResult& fit = k == 0 ? found.nothing : found.fits[beside[k - 1]];
    const double excess = k == 0 ? compared.of_nothing.excess : compared.of_fits[beside[k - 1]].excess;
    laws[k] = unknown_laws(problem, fit, excess, smooth, smooth.left_by(problem, fit, evidence.law_share), evidence, compared.misfit_cost, compared.floor);
  });
  const std::size_t known = candidates.size();
  const double singles = std::max(1.0, static_cast<double>(effect_count)), each = kSmooth / (kVariables * static_cast<double>(SmoothTorques::scales().size()));
  std::vector<std::size_t> added_to;  // which of the known candidates each belongs to; 0: none
  for (std::size_t k = 0; k < laws.size(); ++k) {
    const std::size_t owner = k == 0 ? 0 : beside[k - 1] + 1;
    for (UnknownLaw& law : laws[k]) {
      candidates.push_back({candidates[owner].effects, law.excess, law.prior, std::move(law.information), candidates[owner].at_bounds});
      Candidate& candidate = candidates.back();
      candidate.laws = candidates[owner].laws + 1;
      candidate.chance = each * (k == 0 ? evidence.prior_unknown : evidence.prior_pair * 2.0 / singles * evidence.prior_unknown / evidence.prior_single);
      added_to.push_back(owner);
    }
  }
  Probabilities result = weigh(candidates, static_cast<int>(effect_count), evidence);
  std::vector<double> with_law(known, 0.0);
  for (std::size_t n = 0; n < added_to.size(); ++n) with_law[added_to[n]] += result.candidate[known + n];
  result.unknown_law = std::exchange(with_law.front(), 0.0);
  result.unknown += result.unknown_law;
  result.candidate.resize(known);
  for (std::size_t i = 0; i < known; ++i) {
    result.candidate[i] += with_law[i];
    if (with_law[i] > 0.0) weighed.causes[i].with_unknown_law = with_law[i] / result.candidate[i];
  }
  weighed.probabilities = std::move(result);
}

// `is_controlled`: the commands are a controller's answers.
Weighed weigh_fits(Problem& problem, const Found& found, const SmoothTorques& smooth, std::size_t effect_count, EvidenceSettings evidence, bool is_controlled) {
  const std::optional<ControllerLoop> loop = is_controlled ? std::optional(controller_loop(problem)) : std::nullopt;
  evidence.unknown_floor += kNoise * problem.settings.independent_share * static_cast<double>(difference_count(problem));
  const Leaving of_nothing = by_own_machine(problem, found.nothing, evidence.discrepancy_count, loop);
  std::vector<Leaving> of_fits(found.fits.size());
  share_out(problem, found.fits.size(), [&](std::size_t i) { of_fits[i] = by_own_machine(problem, found.fits[i], evidence.discrepancy_count, loop); });
  double least = std::min(0.0, of_nothing.excess);
  for (std::size_t i = 0; i < found.fits.size(); ++i) {
    if (is_a_measure(found.fits[i].prior, found.fits[i].information, evidence.independent_share)) least = std::min(least, of_fits[i].excess);
  }
  const double nothing_excess = of_nothing.excess;
  const MisfitCost misfit_cost(evidence, nothing_excess - least);
  Weighed weighed;
  std::vector<Candidate> candidates;
  std::vector<Relaxed> relaxed_fits(found.fits.size());
  share_out(problem, found.fits.size(), [&](std::size_t i) { relaxed_fits[i] = relax(problem, found.fits[i], of_fits[i], misfit_cost, least); });
  const auto add_candidate = [&](const FitResult& result, const Relaxed& relaxed) {
    Cause cause = make_cause(problem.catalogue, result);
    cause.excess = relaxed.excess;
    cause.prior = relaxed.prior;
    cause.prior_chance = chance_of_prior(cause.prior, cause.information, evidence.independent_share);
    candidates.push_back({cause.effects, cause.excess, cause.prior, cause.information, count_at_bounds(problem.catalogue, result.point)});
    Candidate& candidate = candidates.back();
    for (const common::EffectInstance& effect : result.point.effects) candidate.laws += common::parts_of(problem.catalogue, effect).size();
    candidate.is_one_cause = candidate.is_one_cause || common::are_the_parts_of_one(problem.catalogue, cause.effects);
    weighed.causes.push_back(std::move(cause));
  };
  add_candidate(found.nothing, relax(problem, found.nothing, of_nothing, misfit_cost, least));
  for (std::size_t i = 0; i < found.fits.size(); ++i) add_candidate(found.fits[i], relaxed_fits[i]);
  weighed.probabilities = weigh(candidates, static_cast<int>(effect_count), evidence);
  const Compared compared{std::move(of_fits), of_nothing, misfit_cost, least, evidence};
  weigh_unknown_laws(problem, found, smooth, compared, effect_count, std::move(candidates), weighed);
  // What is explained is counted down to what the noise, or the best of all fits, leaves.
  const double floor = weighed.probabilities.floor, gap = nothing_excess - floor;
  for (std::size_t i = 0; i < weighed.causes.size(); ++i) {
    Cause& cause = weighed.causes[i];
    cause.probability = weighed.probabilities.candidate[i];
    cause.explained = gap > 0.0 ? std::clamp((nothing_excess - cause.excess) / gap, 0.0, 1.0) : 0.0;
  }
  return weighed;
}

// By falling probability; groups name only causes that are still there.
void sort_causes(std::vector<Cause>& causes) {
  std::stable_sort(causes.begin(), causes.end(), [](const Cause& a, const Cause& b) { return a.probability > b.probability; });
  std::set<std::string> names;
  for (const Cause& cause : causes) names.insert(name_of(cause));
  for (Cause& cause : causes) std::erase_if(cause.group, [&](const Alike& other) { return !names.contains(other.name); });
}

// Sums of the causes' probabilities by effect, by subsystem, and of nothing missing.
void add_up(const common::EffectCatalogue& known, Diagnosis& diagnosis) {
  std::map<std::string, double> by_subsystem, by_effect;
  diagnosis.probability_nothing = 0.0;
  for (const Cause& cause : diagnosis.causes) {
    if (cause.effects.empty()) diagnosis.probability_nothing += cause.probability;
    // Each of the names of one motion is as likely as the others.
    const double share = cause.probability / static_cast<double>(1 + cause.also.size());
    std::vector<std::vector<std::string>> names = cause.also;
    names.push_back(cause.effects);
    for (const std::vector<std::string>& effects : names) {
      std::set<std::string> touched;
      for (const std::string& effect : effects) {
        touched.insert(std::string(common::name_of(known.at(effect).subsystem)));
        by_effect[effect] += share;
      }
      for (const std::string& subsystem : touched) by_subsystem[subsystem] += share;
    }
  }
  const auto falling = [](const std::map<std::string, double>& by_name) {
    std::vector<std::pair<std::string, double>> all(by_name.begin(), by_name.end());
    std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
    return all;
  };
  diagnosis.lead_acts = 0.0;
  for (const Cause& cause : diagnosis.causes) {
    const Cause& first = diagnosis.causes.front();
    const bool has_all = first.effects.empty() ? cause.effects.empty() : std::all_of(first.effects.begin(), first.effects.end(), [&](const std::string& one) {
      return std::find(cause.effects.begin(), cause.effects.end(), one) != cause.effects.end();
    });
    if (has_all) diagnosis.lead_acts += cause.probability;
  }
  diagnosis.subsystems = falling(by_subsystem);
  diagnosis.effects = falling(by_effect);
}

// The answer in one line.
void name_answer(const Cause& first, Diagnosis& diagnosis) {
  diagnosis.gap = diagnosis.controller_differs || diagnosis.counts > 0.0 || diagnosis.probability_nothing + diagnosis.probability_hidden < 0.5;
  diagnosis.is_unknown = diagnosis.probability_unknown > first.probability;
  if (diagnosis.is_unknown) {
    diagnosis.verdict = "outside the catalogue (unknown): no known effect explains what is missing";
  } else if (first.effects.empty()) {
    diagnosis.verdict = "no effect is missing; parameters within their spread explain the records";
  } else {
    diagnosis.verdict = told_name(first);
  }
}

// What of a cause's machine can be fitted again on other records; nothing where none of it can.
std::optional<Point> fitted_part(const common::EffectCatalogue& catalogue, const Cause& cause) {
  Point part = cause.point;
  std::erase_if(part.effects, [&](const common::EffectInstance& effect) { return catalogue.at(effect.name).read_off != common::ReadOff::none; });
  if (part.effects.empty()) return {};
  return part;
}

// The cause without effects; null where there is none.
Cause* nothing_missing(Diagnosis& diagnosis) {
  const auto nothing = std::find_if(diagnosis.causes.begin(), diagnosis.causes.end(), [](const Cause& one) { return one.effects.empty(); });
  return nothing == diagnosis.causes.end() ? nullptr : &*nothing;
}

// Takes a cause's probability and gives it to what is not known, or where the machine without it leaves noise alone, to nothing missing.
void take_away(double share, bool is_nothing_left, Cause& cause, Diagnosis& diagnosis) {
  const double taken = share * cause.probability;
  cause.probability -= taken;
  Cause* const nothing = nothing_missing(diagnosis);
  (is_nothing_left && nothing != nullptr ? nothing->probability : diagnosis.probability_unknown) += taken;
}

// The nominal machine leaves no more than noise: what fits this better fits noise.
void settle_on_nothing(Diagnosis& diagnosis) {
  for (Cause& cause : diagnosis.causes) cause.probability = cause.effects.empty() ? 1.0 : 0.0;
  diagnosis.probability_unknown = 0.0;
}

// Parameters alone leave no more than noise. That some machine would leave less still says little of a cause that nobody knows: at most it is
// as likely as not. A law that was fitted does say something, as far as it is none of the catalogue's.
void doubt_the_unknown_below_the_noise(double unknown_law, Diagnosis& diagnosis) {
  Cause* const nothing = nothing_missing(diagnosis);
  if (nothing == nullptr) return;
  const double fitted = std::min(diagnosis.probability_unknown, kOutsideTheCatalogue * unknown_law);
  const double rest = diagnosis.probability_unknown - fitted, both = nothing->probability + rest;
  const double kept = std::min(rest, kUnknownBelowNoise * std::max(0.0, both - (1.0 - kOutsideTheCatalogue) * unknown_law));
  nothing->probability = both - kept;
  diagnosis.probability_unknown = fitted + kept;
}

// A share of a cause's probability goes to the others that have its effects but for those doubted, by their own probabilities; where there are
// none, as take_away() does.
void hand_on(double share, const std::function<bool(const std::string&)>& is_doubted, bool is_nothing_left, Cause& cause, Diagnosis& diagnosis) {
  const auto has_the_rest = [&](const Cause& other) {
    return &other != &cause && !other.effects.empty() && !(other.validation && !other.validation->holds) &&
           std::all_of(cause.effects.begin(), cause.effects.end(), [&](const std::string& effect) {
             return is_doubted(effect) || std::find(other.effects.begin(), other.effects.end(), effect) != other.effects.end();
           });
  };
  const bool has_rest = !std::all_of(cause.effects.begin(), cause.effects.end(), is_doubted);
  double sum = 0.0;
  for (const Cause& other : diagnosis.causes) sum += has_rest && has_the_rest(other) ? other.probability : 0.0;
  if (!(sum > 0.0)) return take_away(share, is_nothing_left, cause, diagnosis);
  const double taken = share * cause.probability;
  cause.probability -= taken;
  for (Cause& other : diagnosis.causes) {
    if (has_the_rest(other)) other.probability += taken * other.probability / sum;
  }
}

// No cause leads that does not predict data that were not fitted better than the nominal machine and than parameters alone.
// `parameters_of_all` is where parameters alone stand, fitted to all records. Where they stand farther off than machines of one make do, they are no rival of an
// effect that is one of them grown: both predict the same.
void validate_lead(Problem& problem, const WhiteningSettings& whitening, const std::optional<controller::ControllerSettings>& controller,
                   const Point& parameters_of_all, bool are_parameters_likely, Diagnosis& diagnosis) {
  std::vector<HeldOutData> parts;  // held out each in its turn, once there is a lead to ask
  std::vector<Point> parameters_points;               // of each part
  std::vector<ValidationError> nominal, parameters;  // on each part
  const auto on_both = [](const std::vector<ValidationError>& errors) { return together(errors[0], errors[1]); };
  for (int tried = 0;; ++tried) {
    sort_causes(diagnosis.causes);
    Cause& lead = diagnosis.causes.front();
    if (lead.effects.empty() || lead.validation || kOutsideTheCatalogue * diagnosis.probability_unknown > lead.probability) break;
    const std::optional<Point> part = fitted_part(problem.catalogue, lead);
    if (!part) break;
    if (parts.empty()) {
      for (const HeldOutPart held : {HeldOutPart::last, HeldOutPart::first}) parts.emplace_back(problem, whitening, held);
      for (HeldOutData& data : parts) {
        const HeldOut fitted = data.fit(parameters_of_all);
        nominal.push_back(data.error({}, controller));
        parameters.push_back(data.error(fitted, controller));
        parameters_points.push_back(fitted.point);
      }
    }
    const bool is_nothing_left = are_parameters_likely && std::min(on_both(nominal).residual_ratio, on_both(parameters).residual_ratio) <= 1.0;
    const bool is_said_by_parameters =
        !are_parameters_likely && std::all_of(part->effects.begin(), part->effects.end(), [&](const common::EffectInstance& effect) {
          return !problem.catalogue.at(effect.name).stands_for.empty();
        });
    if (tried == kMostValidated) {
      for (Cause& cause : diagnosis.causes) {
        if (!cause.effects.empty()) take_away(1.0, is_nothing_left, cause, diagnosis);
      }
      diagnosis.remarks.push_back("no cause that was tried predicts data that were not fitted better than the nominal machine");
      continue;
    }
    // Of a draw only the power is fitted again, not its shape (how long a burst lasts): the last part alone is asked.
    const bool has_draws = !stochastic_part(problem.catalogue, *part).empty();
    std::vector<HeldOut> fitted;
    for (HeldOutData& data : parts) {
      if (fitted.empty() || !has_draws) fitted.push_back(data.fit(*part));
    }
    Validation validation{has_draws ? nominal[0] : on_both(nominal), has_draws ? parameters[0] : on_both(parameters), {}, {}, false};
    std::optional<controller::ControllerSettings> with = controller;
    if (with) with = controller::with_effects(*controller, lead.controller_effects);
    validation.cause = parts[0].error(fitted[0], with);
    if (has_draws) {
      const Point rest = without_stochastic(problem.catalogue, fitted[0].point);
      validation.unknown_cost = std::min(parts[0].unknown_cost(rest), parts[0].unknown_cost(parameters_points[0]));
    } else {
      validation.cause = together(validation.cause, parts[1].error(fitted[1], with));
    }
    validation.holds = holds(validation, is_said_by_parameters);
    lead.validation = validation;
    if (validation.holds) {
      const std::optional<double> before = validation.parameters.closed_loop, after = validation.cause.closed_loop;
      if (before && after && *after > kWorse * *before) {
        diagnosis.remarks.push_back(fmt::format("the closed loop with {} is further off than with parameters alone ({:.2g} after {:.2g} of the signals), though where the model "
                                                "is led along, it leaves {:.2g} times the noise and not {:.2g}",
                                                name_of(lead), *after, *before, validation.cause.residual_ratio, validation.parameters.residual_ratio));
      }
      diagnosis.held_out = std::move(fitted.front());
      break;
    }
    const bool is_better_without_stochastic = validation.unknown_cost && !is_nothing_left;
    if (is_better_without_stochastic) {
      const auto is_stochastic_effect = [&](const std::string& one) {
        const common::EffectAbout* about = problem.catalogue.find(one);
        return about != nullptr && is_stochastic(*about);
      };
      hand_on(1.0, is_stochastic_effect, false, lead, diagnosis);
    } else {
      take_away(1.0, is_nothing_left, lead, diagnosis);
    }
  }
  for (const HeldOutData& data : parts) {
    problem.simulations += data.simulations();
    problem.simulation_time += data.simulation_time();
  }
}

// Of torques that were measured, without what lies before them: it shows in none, and a lag that is not there would keep the measurement's noise from the machine.
DiagnosisSettings without_what_is_before_torques(DiagnosisSettings settings, const std::vector<Record>& records, const common::EffectCatalogue& catalogue, std::vector<std::string>& remarks) {
  const auto measured = std::find_if(records.begin(), records.end(), [](const Record& record) { return record.has_measured_torque; });
  if (measured == records.end()) return settings;
  std::string names;
  for (const common::EffectAbout& about : catalogue.effects) {
    if (!about.before_torque) continue;
    settings.without.emplace_back(about.name);
    names += (names.empty() ? "" : ", ") + std::string(about.name);
  }
  remarks.push_back(fmt::format("{}: of torques that were measured, with noise of {:.2g} Nm, nothing tells what lies before them: {}", measured->name, std::sqrt(measured->torque_noise), names));
  return settings;
}

// [s] Where effects begin to count their time: at zero of the clock that records have in common, by which they know one roll; of records that all begin later than they are long at the first
// beginning, or phases would go with the period so steeply that no fit finds them. One that begins far from the others goes by another clock, and counts from its own beginning.
double effects_from(std::span<const Record> records, const Record& record) {
  constexpr double kOfAnotherClock = 10.0;  // times the longest record's length; chosen
  double first = std::numeric_limits<double>::infinity(), longest = 0.0;
  for (const Record& one : records) {
    first = std::min(first, one.start_time);
    longest = std::max(longest, one.step * static_cast<double>(one.size()));
  }
  if (std::fabs(record.start_time - first) > kOfAnotherClock * longest) return record.start_time;
  return first > longest ? first : 0.0;
}

// From the records to the problem that is fitted. Gives how their differences are whitened. Throws NotAdmitted.
WhiteningSettings take_records(const sim::MachineSettings& nominal, std::vector<Record> records, const DiagnosisSettings& settings, Problem& problem, Diagnosis& diagnosis) {
  for (Record& record : records) record.effects_from = effects_from(records, record);
  set_machine(nominal, records, problem);
  if (settings.noise_corner) problem.thresholds.whitening.noise_corner = *settings.noise_corner;
  const WhiteningSettings whitening = whitening_for(problem.thresholds, has_coarse_counts(records));
  diagnosis.followed = admit(std::move(records), whitening, problem, diagnosis.remarks);
  diagnosis.nuisances = problem.nuisances;
  const std::vector<common::EffectInstance> starts =
      catalogue_starts(problem.catalogue, problem.nominal, settings.without, last_moment(problem), problem.thresholds.spell_every);
  problem.force_steps = steps_for_forces(problem, starts, settings.evidence);
  return whitening;
}

// The answer on records that had no part in it.
void judge_unseen(Problem& problem, const WhiteningSettings& whitening, const std::optional<controller::ControllerSettings>& controller,
                  const Point& parameters_of_all, std::vector<Record> unseen, Diagnosis& diagnosis) {
  std::optional<Point> answer;
  if (!diagnosis.is_unknown && !diagnosis.causes.empty()) answer = fitted_part(problem.catalogue, diagnosis.causes.front());
  for (Record& record : unseen) {
    const std::string name = record.name;
    record.effects_from = effects_from({problem.records.data(), problem.records.size()}, record);
    std::optional<HeldOutData> admitted;
    try {
      admitted.emplace(problem, whitening, std::move(record), diagnosis.remarks);
    } catch (const NotAdmitted& problem_of_it) {
      diagnosis.remarks.push_back(fmt::format("{} could not be predicted: {}", name, problem_of_it.what()));
      continue;
    }
    HeldOutData& data = *admitted;
    const HeldOut parameters = data.fit(parameters_of_all);
    const HeldOut cause = answer ? data.fit(*answer) : parameters;
    UnseenRecord judged{parameters.record, {data.error({}, controller), data.error(parameters, controller), {}, {}, false},
                        data.missing_torque({}), data.missing_torque(parameters), 0.0};
    judged.validation.cause = answer ? data.error(cause, controller) : judged.validation.parameters;
    judged.validation.holds = answer && holds(judged.validation);
    judged.cause_torque = answer ? data.missing_torque(cause) : judged.parameters_torque;
    diagnosis.unseen.push_back(std::move(judged));
    problem.simulations += data.simulations();
    problem.simulation_time += data.simulation_time();
  }
}

// An effect that was fitted to the end of its range is no sure answer: a larger one would fit better. Nor is one whose interval
// goes beyond its range: the records do not say that it is there; nor one beside which a parameter is farther off than machines of one
// make differ, or all together are: then something else may hide in them, beside nothing missing as well. What is taken from an effect goes to
// nothing missing where parameters alone leave noise.
void doubt_what_no_machine_has(const Problem& problem, bool is_nothing_left, Diagnosis& diagnosis) {
  const common::EffectCatalogue& catalogue = problem.catalogue;
  constexpr double kAtTheEnd = 1e-6;  // of the range
  for (Cause& cause : diagnosis.causes) {
    const auto parameters = cause.point.nuisance.begin();
    const auto count = static_cast<std::ptrdiff_t>(std::min(cause.point.nuisance.size(), problem.nuisances.parameters.size()));
    const bool is_far_off = std::any_of(parameters, parameters + count, [](double amount) { return std::fabs(amount) > kFarOff; });
    const bool is_nothing = cause.effects.empty();
    if (is_nothing && diagnosis.mean_square_nominal <= 1.0) continue;  // with every parameter where the file has it
    if (is_far_off || cause.prior_chance < kFarTogether) take_away(kDoubtful, is_nothing_left && !is_nothing, cause, diagnosis);
    for (const common::EffectInstance& effect : cause.point.effects) {
      const common::EffectAbout& about = catalogue.at(effect.name);
      // Of its size: shares and shapes may well lie at an end of theirs.
      const common::EffectParameter& parameter = about.parameters[common::kSize];
      const double range = parameter.upper - parameter.lower, value = effect.values[common::kSize];
      if (!std::isfinite(range) || is_all_round(parameter)) continue;
      const bool is_at_upper = value > parameter.upper - kAtTheEnd * range;
      const bool is_at_lower = value < parameter.lower + kAtTheEnd * range && !(parameter.absent && *parameter.absent <= parameter.lower);
      const std::string name = fmt::format("{}.{}", effect.name, parameter.name);
      const auto size = std::find_if(cause.sizes.begin(), cause.sizes.end(), [&](const Size& one) { return one.parameter == name; });
      const bool is_undetermined = size != cause.sizes.end() && (size->low < parameter.lower || size->high > parameter.upper);
      if (is_undetermined) {
        size->low = std::max(size->low, parameter.lower);
        size->high = std::min(size->high, parameter.upper);
      }
      if (!is_at_upper && !is_at_lower && !is_undetermined) continue;
      if (&cause == &diagnosis.causes.front()) {
        diagnosis.remarks.push_back(is_at_upper || is_at_lower
                                        ? fmt::format("{} was fitted to the {} end of its range, {:.3g} {}", name, is_at_upper ? "upper" : "lower",
                                                      value, common::name_of(parameter.unit))
                                        : fmt::format("{}: the 90 % interval goes beyond what it can be; these records do not determine it", name));
      }
      hand_on(kDoubtful, [&](const std::string& one) { return one == effect.name; }, is_nothing_left, cause, diagnosis);
    }
  }
}

// No cause explains it: then it may still be a known effect with a law of its own. What its law is not is no noise, so the causes share by their evidence
// with that much less weight.
void share_with_other_laws(Diagnosis& diagnosis) {
  const auto weight = [](const Cause& cause) { return cause.effects.empty() ? 0.0 : std::pow(cause.probability * (1.0 - cause.with_unknown_law), 1.0 / kOtherLawTemper); };
  double sum = 0.0;
  for (const Cause& cause : diagnosis.causes) sum += weight(cause);
  if (!(sum > 0.0)) return;
  const double shared = (1.0 - kOutsideTheCatalogue) * diagnosis.probability_unknown;
  diagnosis.probability_unknown -= shared;
  for (Cause& cause : diagnosis.causes) {
    // None comes to lead by that which has not predicted anything.
    const bool may_lead = cause.validation && cause.validation->holds;
    const double share = shared * weight(cause) / sum, room = std::max(0.0, diagnosis.probability_unknown - cause.probability);
    const double taken = may_lead ? share : std::min(share, room);
    cause.probability += taken;
    diagnosis.probability_unknown += share - taken;
  }
}

// Of a controller whose answers could not be compared nobody knows whether it is as its settings say: that nothing is missing is then no more
// certain than effects of the controller are rare, among all effects alone or as one of two.
void leave_room_for_the_controller(std::size_t of_the_controller, std::size_t all, const EvidenceSettings& evidence, Diagnosis& diagnosis) {
  Cause* const nothing = nothing_missing(diagnosis);
  if (nothing == nullptr || all == 0) return;
  const double share = static_cast<double>(of_the_controller) / static_cast<double>(all);
  const double room = evidence.prior_single * share + evidence.prior_pair * (1.0 - (1.0 - share) * (1.0 - share));
  take_away(room / (evidence.prior_nothing + room), false, *nothing, diagnosis);
}

// Where nothing missing leads, it is no more certain than these records would show what is: an effect may act and be too small for them. It goes on leading.
void leave_room_for_the_hidden(const Problem& problem, const Screening& screening, const EvidenceSettings& evidence, Diagnosis& diagnosis) {
  if (diagnosis.causes.empty() || !diagnosis.causes.front().effects.empty()) return;
  const Hidden hidden = hidden_effects(problem.catalogue, screening.tried, static_cast<int>(screening.names.size()), evidence);
  Cause& nothing = diagnosis.causes.front();
  const double next = diagnosis.causes.size() > 1 ? diagnosis.causes[1].probability : 0.0;
  const double spare = nothing.probability - std::max(next, diagnosis.probability_unknown);
  diagnosis.probability_hidden = std::clamp(nothing.probability * hidden.odds / (1.0 + hidden.odds), 0.0, std::max(0.0, spare));
  nothing.probability -= diagnosis.probability_hidden;
  for (const auto& [effect, share] : hidden.effects) {
    if (share > 0.5) diagnosis.hidden.push_back(effect);
  }
}

// What the evidence cannot know of the lead: it weighs hypotheses as they are fitted, and each is less sure than its best fit says.
void calibrate_lead(Diagnosis& diagnosis) {
  sort_causes(diagnosis.causes);
  if (diagnosis.causes.empty()) return;
  Cause& lead = diagnosis.causes.front();
  if (diagnosis.probability_unknown >= lead.probability) return;
  const double above = std::clamp((lead.mean_square - 1.0) / kNoise, 0.0, 1.0);
  if (lead.effects.empty()) {
    const double room = kSmallBesideNothing * above;
    return take_away(room / (1.0 + room), false, lead, diagnosis);
  }
  const double spare = std::max(0.0, 1.0 - diagnosis.probability_unknown / lead.probability);
  take_away(std::min(kAboveTheNoise * above, 0.5 * spare), false, lead, diagnosis);
  if (lead.effects.size() > 1 || lead.probability < kClearLead) return;
  hand_on(kHiddenBeside, [](const std::string&) { return false; }, false, lead, diagnosis);
}

// The fit whose residual nobody has explained: that of the answer, or of parameters alone where there is none. Null where only draws of its stochastic
// effects are left, which follow nothing.
const FitResult* unexplained_fit(const Problem& problem, const Found& found, const Diagnosis& diagnosis, const Cause& first) {
  if (!diagnosis.gap) return nullptr;
  if (diagnosis.is_unknown || first.point.effects.empty()) return &found.nothing;
  if (!stochastic_part(problem.catalogue, first.point).empty()) return nullptr;
  for (const FitResult& one : found.fits) {
    if (has_same_effects(one.point, first.point)) return &one;
  }
  return nullptr;
}

// What the answer's parameters say: swings of the load, and parameters that had to go farther than machines of one make differ.
void remark_parameters(const Problem& problem, const Point& answer, double prior_chance, Diagnosis& diagnosis) {
  if (!diagnosis.is_unknown && prior_chance < kFarTogether) {
    diagnosis.remarks.push_back(fmt::format("with this answer the parameters, and what swings when the records begin, are all together further off than in one machine of one make in {:.0f}; an effect that they imitate may hide in them",
                                            std::min(kMostMachines, 1.0 / prior_chance)));
  }
  std::string far;
  const std::vector<sim::Parameter>& parameters = problem.nuisances.parameters;
  for (std::size_t k = 0; k < std::min(answer.nuisance.size(), parameters.size()); ++k) {
    if (std::fabs(answer.nuisance[k]) < kFarOff) continue;
    far += fmt::format("{}{} {:+.0f} %", far.empty() ? "" : ", ", parameters[k].name, 100.0 * parameters[k].spread * answer.nuisance[k]);
  }
  for (std::size_t r = 0; r < problem.records.size(); ++r) {
    const double reach = swing_reach(problem.nuisances, answer.nuisance, r);
    if (reach < kWorthASwing) continue;
    diagnosis.remarks.push_back(fmt::format("{}: the load swings when the record begins, up to {:.1f} mrad from where it would hang still",
                                            problem.records[r].name, 1e3 * reach));
  }
  if (far.empty() && !diagnosis.is_unknown) return;
  diagnosis.remarks.push_back(
      fmt::format("cannot tell whether this is another crane than the nominal one: {}; check that the crane file is this crane's",
                  far.empty() ? "neither a known effect nor parameters within their spread explain it"
                              : "the best fit wants " + far + ", more than machines of one make differ"));
}

// A gap below the noise that the sensors are taken to have: what shows it.
void remark_below_the_noise(Diagnosis& diagnosis) {
  for (const std::string& variable : followed_variables(diagnosis.discrepancies)) {
    diagnosis.remarks.push_back(fmt::format("what parameters alone leave is no more than the sensors' noise is taken to be; that it follows the {} as noise does not (ln of the odds {:.0f}) is what shows that something is missing",
                                            variable, diagnosis.discrepancies.front().evidence));
  }
}

}  // namespace

sim::MachineSettings as_fitted(sim::MachineSettings nominal, const Diagnosis& diagnosis) {
  sim::MachineSettings machine = with_boom_elements(std::move(nominal), diagnosis.boom_elements);
  machine.effects.insert(machine.effects.end(), diagnosis.of_every_machine.begin(), diagnosis.of_every_machine.end());
  return machine;
}

Diagnosis diagnose(const sim::MachineSettings& nominal, const std::optional<controller::ControllerSettings>& controller,
                   std::vector<Record> records, const DiagnosisSettings& asked, const Progress& progress,
                   const std::function<bool()>& is_stopped, std::vector<Record> unseen) {
  const auto start_time = std::chrono::steady_clock::now();
  std::mutex telling;
  const auto tell = [&](double share, const std::string& doing) {
    const std::lock_guard lock(telling);
    if (progress) progress(share, doing);
  };
  Diagnosis diagnosis;
  Problem problem;
  const DiagnosisSettings settings = without_what_is_before_torques(asked, records, sim::effects_for(nominal), diagnosis.remarks);
  problem.settings = settings.fit;
  problem.threads = settings.threads;
  if (is_stopped) problem.is_stopped = is_stopped;
  WhiteningSettings whitening = take_records(nominal, std::move(records), settings, problem, diagnosis);

  tell(0.0, "replaying the controller");
  if (controller) replay(problem, *controller, diagnosis);

  FitResult nominal_machine;
  const Searched searched = search_to_the_floor(problem, whitening, nominal_machine, settings, diagnosis, tell);
  const auto& [base, screening, found] = searched;
  diagnosis.boom_elements = problem.nominal.crane.boom.element_count;
  diagnosis.mean_square_nominal = nominal_machine.mean_square;
  if (const std::optional<FitResult> begun = nominal_with_beginnings(problem, base)) diagnosis.mean_square_nominal = std::min(diagnosis.mean_square_nominal, begun->mean_square);
  diagnosis.mean_square_parameters = base.mean_square;
  diagnosis.moments = largest_moments(problem, base.point, kMoments);
  const Projector project(base.columns, prior_rows(problem, base.point), data_weight(base.difference, settings.fit));
  EvidenceSettings evidence = settings.evidence;
  evidence.independent_share = problem.settings.independent_share;
  diagnosis.not_excited = not_excited(screening, evidence);
  tell(kHoldOut.from, "looking for a law that is in no catalogue");
  const SmoothTorques smooth(problem, searched.best(problem.catalogue));
  Weighed weighed = weigh_fits(problem, found, smooth, screening.names.size(), evidence, diagnosis.has_controller);
  // The gap lies where the most probable cause takes something away; where none does, where more than noise is left.
  const FitResult* const answer_fit = weighed.answer(found.fits);
  const bool is_taken = answer_fit != nullptr && !is_stochastic(problem.catalogue.at(answer_fit->point.effects[0].name));
  diagnosis.bands = bands_of_gap(problem, base.difference, is_taken ? answer_fit->difference : Eigen::VectorXd::Ones(base.difference.size()));
  find_groups(problem, base, project, found.fits, std::span(weighed.probabilities.candidate).subspan(1), std::span(weighed.causes).subspan(1));

  const bool are_parameters_likely = weighed.causes.front().prior_chance >= kFarTogether;  // with nothing missing
  Ranking ranking{std::move(weighed.causes), weighed.probabilities.unknown};
  const double unknown_law = weighed.probabilities.unknown_law;
  merge_same_motion(found.same_as, ranking);
  if (diagnosis.controller_differs) {
    tell(kHoldOut.from, "fitting the controller");
    diagnosis.controller_causes = fit_controller(problem.records, *controller, settings.without, problem.is_stopped,
                                                 [&](std::size_t count, const std::function<void(std::size_t)>& work) { share_out(problem, count, work); });
    add_controller_causes(controller::effects_for(*controller), diagnosis.controller_causes, ranking);
  }
  diagnosis.counts = add_counts(problem, settings.without, ranking);
  diagnosis.causes = std::move(ranking.causes);
  diagnosis.probability_unknown = ranking.unknown;
  if (diagnosis.mean_square_nominal <= 1.0 && !diagnosis.controller_differs && diagnosis.counts == 0.0) settle_on_nothing(diagnosis);
  const bool is_nothing_left = found.nothing.mean_square <= 1.0 && are_parameters_likely && !diagnosis.controller_differs && diagnosis.counts == 0.0;
  if (is_nothing_left) doubt_the_unknown_below_the_noise(unknown_law, diagnosis);
  doubt_what_no_machine_has(problem, is_nothing_left, diagnosis);
  if (settings.hold_out && !diagnosis.causes.empty()) {
    tell(kHoldOut.from, "fitting without the last record");
    validate_lead(problem, whitening, controller, found.nothing.point, are_parameters_likely, diagnosis);
    if (is_nothing_left) doubt_the_unknown_below_the_noise(unknown_law, diagnosis);
  }
  if (!is_nothing_left) share_with_other_laws(diagnosis);
  const common::EffectCatalogue of_the_controller = controller ? controller::effects_for(*controller) : common::EffectCatalogue{};
  const common::EffectCatalogue known = joined(problem.catalogue, of_the_controller);
  if (controller && !diagnosis.has_controller) {
    leave_room_for_the_controller(of_the_controller.effects.size(), known.effects.size(), evidence, diagnosis);
  }
  calibrate_lead(diagnosis);
  sort_causes(diagnosis.causes);
  leave_room_for_the_hidden(problem, screening, evidence, diagnosis);
  add_up(known, diagnosis);
  static const Cause kNone;
  const Cause& first = diagnosis.causes.empty() ? kNone : diagnosis.causes.front();
  name_answer(first, diagnosis);
  if (controller && !diagnosis.has_controller && !diagnosis.gap) diagnosis.verdict += "; what the controller answered could not be compared";
  if (const FitResult* const left = unexplained_fit(problem, found, diagnosis, first)) {
    tell(kFollow.from, "looking for what the rest follows");
    const bool is_fitted = diagnosis.is_unknown && unknown_law > 0.5;
    diagnosis.discrepancies = is_fitted ? smooth.left_by(problem, *left, evidence.law_share) : discrepancies(problem, *left, smooth, evidence.law_share);
    if (is_fitted && is_nothing_left) remark_below_the_noise(diagnosis);
  }
  if (!unseen.empty()) tell(kFollow.from, "predicting what was not fitted");
  judge_unseen(problem, whitening, controller, found.nothing.point, std::move(unseen), diagnosis);
  for (const common::EffectInstance& one : diagnosis.of_every_machine) {
    diagnosis.remarks.push_back(fmt::format("the records show {} ({}), which every machine has and a linear model leaves out: taken as a part of this one, no cause", one.name,
                                            known.at(one.name).physics));
  }
  const Point& answer = first.point.nuisance.empty() ? base.point : first.point;
  remark_parameters(problem, answer, first.prior_chance, diagnosis);

  Point followed = answer;
  const auto is_fitted = [&](const common::EffectInstance& effect) { return has_fit(known.at(effect.name)); };
  std::erase_if(followed.effects, [&](const common::EffectInstance& effect) { return !is_fitted(effect); });
  diagnosis.followed.explained = shadow_at(problem, followed, problem.records.size() - 1);
  diagnosis.simulations = problem.simulations;
  diagnosis.simulation_seconds = 1e-9 * static_cast<double>(problem.simulation_time);
  diagnosis.total_seconds = seconds_since(start_time);
  tell(1.0, "done");
  return diagnosis;
}

}  // namespace slewlab::diagnosis
