#include "diagnosis/balance/balance_fit.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnosis/balance/balance_priors.h"
#include "diagnosis/balance/balance_probability.h"
#include "diagnosis/balance/balance_search.h"
#include "diagnosis/balance/balance_sizes.h"
#include "diagnosis/balance/balance_unknown.h"
#include "diagnosis/balance/balance_validation.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kNegligible = 1e-4;  // probability that is not told

double belief(const BalanceAnswer& answer, const BalanceTerm& term) {
  const auto law = std::find_if(answer.laws.begin(), answer.laws.end(), [&](const LawProbability& one) { return one.law == term.law; });
  return law == answer.laws.end() ? 1.0 : law->belief;
}

}  // namespace

std::vector<FamilyProbability> family_probabilities(const BalanceAnswer& answer) {
  std::vector<FamilyProbability> families{{LawFamily::friction}, {LawFamily::load}, {LawFamily::drive}};
  for (const BalanceModel& model : answer.models) {
    for (FamilyProbability& one : families) {
      double none = 1.0;
      for (const BalanceTerm& term : model.terms) {
        if (term.family == one.family) none *= 1.0 - belief(answer, term);
      }
      one.probability += model.probability * (1.0 - none);
    }
  }
  return families;
}

double believed_probability(const BalanceAnswer& answer, const BalanceModel& model) {
  double believed = model.probability;
  for (const BalanceTerm& term : model.terms) believed *= belief(answer, term);
  return believed;
}

std::vector<LawProbability> law_probabilities(const BalanceAnswer& answer) {
  std::vector<LawProbability> all = answer.laws;
  for (LawProbability& one : all) {
    for (const BalanceTerm& term : answer.best.terms) {
      if (term.law == one.law) one.probability = term.probability;
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const LawProbability& a, const LawProbability& b) { return a.probability > b.probability; });
  return all;
}

BalanceAnswer fit_balance(const std::vector<BalanceRecord>& records, const std::vector<BalanceLaw>& laws, double nominal_inertia,
                          double resolved_speed) {
  const Regression regression = prepared_regression(records, laws, nominal_inertia, resolved_speed);
  BalanceAnswer answer;
  answer.judged_share = regression.count / regression.all;
  for (const RegressionBlock& block : regression.blocks) {
    answer.nominal += (block.square - 2.0 * nominal_inertia * block.with_effort(0) + nominal_inertia * nominal_inertia * block.products(0, 0)) / regression.count;
  }
  const ValidatedChoice alone = validate(regression, laws, {});
  const std::vector<ValidatedChoice> candidates = candidates_of(regression, laws, alone);
  const auto [probability, inclusion, unknown, top] = set_probabilities(candidates, laws, regression, alone, unknown_validation(records, regression));
  answer.probability_unknown = unknown;
  const ValidatedChoice& best = candidates[top];
  const auto [left, gap] = compared(best, alone);
  answer.parameters = gap;
  answer.explained = gap > 0.0 ? 1.0 - left / gap : 0.0;
  answer.independent_count = regression.count / correlation_length(regression, best);
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    if (k != top && probability[k] < kNegligible) continue;
    BalanceModel model = to_model(regression, laws, candidates[k], answer.independent_count);
    model.probability = probability[k];
    for (std::size_t t = 0; t < model.terms.size(); ++t) model.terms[t].probability = inclusion[static_cast<std::size_t>(candidates[k].choice.laws[t].first)];
    if (k == top) answer.best = model;
    answer.models.push_back(std::move(model));
  }
  for (std::size_t k = 0; k < best.choice.laws.size(); ++k) {
    const auto [without, with] = compared(validate(regression, laws, without_law(best.choice, k)), best);
    answer.best.terms[k].share = gap > 0.0 ? std::max(0.0, (without - with) / gap) : 0.0;
  }
  BalanceModel stated = answer.best;
  const ValidatedChoice whole = with_details(regression, laws, best);
  BalanceModel with = to_model(regression, laws, whole, answer.independent_count);
  take_details(answer.best, with);
  for (BalanceTerm& term : with.details) term.probability = inclusion[static_cast<std::size_t>(chosen_law(laws, term.law)->first)];
  answer.best = std::move(with);
  widen(answer.best, stated);
  // The answer first, though another may be a little likelier than it.
  const auto is_best = [&](const BalanceModel& model) { return model.words() == answer.best.words(); };
  std::stable_sort(answer.models.begin(), answer.models.end(), [&](const BalanceModel& a, const BalanceModel& b) {
    return is_best(a) != is_best(b) ? is_best(a) : a.probability > b.probability;
  });
  answer.models.front() = std::move(stated);
  for (std::size_t l = 0; l < laws.size(); ++l) answer.laws.push_back({laws[l].name, laws[l].words, laws[l].family, inclusion[l]});
  answer.remainder = find_remainder(records, regression, best);
  return answer;
}

}  // namespace slewlab::diagnosis
