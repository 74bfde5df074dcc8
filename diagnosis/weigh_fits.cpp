#include "diagnosis/weigh_fits.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "diagnosis/controller_loop.h"
#include "diagnosis/coordinates.h"
#include "diagnosis/own_noise.h"
#include "diagnosis/unknown_law.h"
#include "diagnosis/validate.h"

namespace slewlab::diagnosis {

namespace {

// The residual power of a fit, by what the sensors' noise makes of its machine. Differences that have been divided already by a stochastic effect's
// power have the less noise beside it, the more of that power there is: they are not allowed more of it than in the nominal machine.
PowerAbout by_own_machine(const Problem& problem, const FitResult& result, double discrepancy_count, const std::optional<ControllerLoop>& loop) {
  const Point rest = without_stochastic(problem.catalogue, result.point);
  const double share = problem.settings.independent_share;
  const double by_loop = loop ? share * loss_by_loop(problem, *loop, rest) : 0.0;
  if (rest.effects.size() < result.point.effects.size()) {
    return {result.residual_power + by_loop + share * (square_by_less_noise(problem, rest, result.difference, discrepancy_count) - result.difference.squaredNorm()), {}, {}};
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
  std::vector<PowerAbout> of_fits;
  PowerAbout of_nothing;
  MisfitCost misfit_cost;
  double floor = 0.0;
  EvidenceSettings evidence;
};

// With laws that are in no catalogue, alone or beside an effect, as hypotheses of their own: their probability is that of an unknown cause, or of the
// effect whose residual they explain.
void weigh_unknown_laws(Problem& problem, const Found& found, const SmoothTorques& smooth, const Compared& compared, std::size_t effect_count, std::vector<Candidate> candidates, Weighed& weighed) {
  constexpr double kSmooth = 0.5;    // share of unknown laws that are such functions; chosen
  constexpr double kVariables = 5.0;
  const EvidenceSettings& evidence = compared.evidence;
  const std::vector<std::size_t> beside = fits_to_ask_beside(problem.catalogue, found.fits, weighed.answer(found.fits));
  std::vector<UnknownLaws> laws(beside.size() + 1);
  double least_cost = found.nothing.cost;
  weighed.least_mean_square = found.nothing.mean_square;
  for (const FitResult& fit : found.fits) {
    if (!stochastic_part(problem.catalogue, fit.point).empty()) continue;
    least_cost = std::min(least_cost, fit.cost);
    weighed.least_mean_square = std::min(weighed.least_mean_square, fit.mean_square);
  }
  const auto laws_beside = [&](const FitResult& fit, double residual_power, const FittedLaw* elsewhere) {
    return unknown_laws(problem, fit, residual_power, smooth, smooth.of_residual(problem, fit, evidence.law_share), evidence, compared.misfit_cost, compared.floor, least_cost, elsewhere);
  };
  share_out(problem, beside.size(), [&](std::size_t k) { laws[k + 1] = laws_beside(found.fits[beside[k]], compared.of_fits[beside[k]].residual_power, nullptr); });
  const FittedLaw* best = nullptr;
  for (const UnknownLaws& one : laws) {
    least_cost = std::min(least_cost, one.least_cost);
    if (one.best && (best == nullptr || one.best->difference.squaredNorm() < best->difference.squaredNorm())) best = &*one.best;
  }
  laws.front() = laws_beside(found.nothing, compared.of_nothing.residual_power, best);
  for (const UnknownLaws& one : laws) {
    if (one.best) weighed.least_mean_square = std::min(weighed.least_mean_square, mean_square(one.best->difference));
  }
  const std::size_t known = candidates.size();
  const double singles = std::max(1.0, static_cast<double>(effect_count)), each = kSmooth / (kVariables * static_cast<double>(SmoothTorques::scales().size()));
  std::vector<std::size_t> added_to;  // which of the known candidates each belongs to; 0: none
  for (std::size_t k = 0; k < laws.size(); ++k) {
    const std::size_t owner = k == 0 ? 0 : beside[k - 1] + 1;
    for (UnknownLaw& law : laws[k].of_every_size) {
      candidates.push_back({candidates[owner].effects, law.residual_power, law.prior, std::move(law.information), candidates[owner].at_bounds});
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

}  // namespace

const FitResult* Weighed::answer(const std::vector<FitResult>& fits) const {
  const auto likeliest = std::max_element(probabilities.candidate.begin() + 1, probabilities.candidate.end());
  if (likeliest == probabilities.candidate.end() || probabilities.unknown >= *likeliest) return nullptr;
  return &fits[static_cast<std::size_t>(likeliest - probabilities.candidate.begin() - 1)];
}

std::vector<std::size_t> fits_to_ask_beside(const common::EffectCatalogue& catalogue, const std::vector<FitResult>& fits, const FitResult* answer) {
  std::vector<std::size_t> asked;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    const Point& point = fits[i].point;
    if (point.effects.size() != 1 || !stochastic_part(catalogue, point).empty()) continue;
    const bool leads = answer != nullptr && has_effect(answer->point.effects, point.effects.front().name);
    if (asked.empty() || leads) asked.push_back(i);
  }
  return asked;
}

Weighed weigh_fits(Problem& problem, const Found& found, const SmoothTorques& smooth, std::size_t effect_count, EvidenceSettings evidence, bool is_controlled) {
  const std::optional<ControllerLoop> loop = is_controlled ? std::optional(controller_loop(problem)) : std::nullopt;
  evidence.unknown_floor += kNoise * problem.settings.independent_share * static_cast<double>(difference_count(problem));
  const PowerAbout of_nothing = by_own_machine(problem, found.nothing, evidence.discrepancy_count, loop);
  std::vector<PowerAbout> of_fits(found.fits.size());
  share_out(problem, found.fits.size(), [&](std::size_t i) { of_fits[i] = by_own_machine(problem, found.fits[i], evidence.discrepancy_count, loop); });
  double least = std::min(0.0, of_nothing.residual_power);
  for (std::size_t i = 0; i < found.fits.size(); ++i) {
    if (is_a_measure(found.fits[i].prior, found.fits[i].information, evidence.independent_share)) least = std::min(least, of_fits[i].residual_power);
  }
  const double nothing_residual_power = of_nothing.residual_power;
  const MisfitCost misfit_cost(evidence, nothing_residual_power - least);
  Weighed weighed;
  std::vector<Candidate> candidates;
  std::vector<Relaxed> relaxed_fits(found.fits.size());
  share_out(problem, found.fits.size(), [&](std::size_t i) { relaxed_fits[i] = relax(problem, found.fits[i], of_fits[i], misfit_cost, least); });
  const auto add_candidate = [&](const FitResult& result, const Relaxed& relaxed) {
    Cause cause = make_cause(problem.catalogue, result);
    cause.residual_power = relaxed.residual_power;
    cause.prior = relaxed.prior;
    cause.prior_chance = chance_of_prior(cause.prior, cause.information, evidence.independent_share);
    candidates.push_back({cause.effects, cause.residual_power, cause.prior, cause.information, count_at_bounds(problem.catalogue, result.point)});
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
  // The share of the gap explained is counted down to the noise, or to the residual of the best of all fits.
  const double floor = weighed.probabilities.floor, gap = nothing_residual_power - floor;
  for (std::size_t i = 0; i < weighed.causes.size(); ++i) {
    Cause& cause = weighed.causes[i];
    cause.probability = weighed.probabilities.candidate[i];
    cause.explained = gap > 0.0 ? std::clamp((nothing_residual_power - cause.residual_power) / gap, 0.0, 1.0) : 0.0;
  }
  return weighed;
}

}  // namespace slewlab::diagnosis
