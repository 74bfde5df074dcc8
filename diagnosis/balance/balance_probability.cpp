#include "diagnosis/balance/balance_probability.h"

#include <algorithm>
#include <cmath>

namespace slewlab::diagnosis {

namespace {

constexpr double kFrictionPrior = 0.3;   // odds of an ordinary friction more, its Occam factor included: learned likewise
constexpr double kLoadPrior = 0.15;      // of an ordinary load
constexpr double kRarePrior = 0.05;      // of any of the others, likewise
constexpr double kRestShare = 0.05;      // of the gap, that the residual of known laws may be where they are the answer; what it follows is said beside it
constexpr double kUnknownPrior = 0.02;   // of a law outside the catalogue, against the best of those in it
constexpr double kRatioDeviation = 0.1;  // of the logarithm of the ratio of two laws' residuals: learned on simulated axes, docs/axis.md
constexpr double kMedianShare = 0.2;     // of the likeliest model's probability, that the model of all likely laws has at least

// ln of the prior of a set of laws. Every machine has friction, many a constant torque as well; the others share what one of them has. Where a spring rests is no law beside it.
double log_prior(const std::vector<BalanceLaw>& laws, const LawChoice& choice) {
  const auto others = static_cast<double>(std::count_if(laws.begin(), laws.end(), [](const BalanceLaw& law) { return !law.is_ordinary; }));
  const auto name_of = [&](const auto& law) -> const std::string& { return laws[static_cast<std::size_t>(law.first)].name; };
  const bool has_spring = std::any_of(choice.laws.begin(), choice.laws.end(), [&](const auto& law) { return name_of(law) == "spring"; });
  double sum = 0.0;
  for (const auto& [law, shape] : choice.laws) {
    const BalanceLaw& chosen = laws[static_cast<std::size_t>(law)];
    if (has_spring && chosen.name == "offset") continue;
    sum += std::log(!chosen.is_ordinary ? kRarePrior / others : chosen.family == LawFamily::friction ? kFrictionPrior : kLoadPrior);
  }
  return sum;
}

// The candidate with the smallest residual, each law more at its prior.
const ValidatedChoice& reference_of(const std::vector<ValidatedChoice>& candidates, const std::vector<BalanceLaw>& laws, const Regression& regression, double floor) {
  const ValidatedChoice& least = *std::min_element(candidates.begin(), candidates.end(), [](const ValidatedChoice& a, const ValidatedChoice& b) { return a.of_blocks < b.of_blocks; });
  const double independent = regression.count / correlation_length(regression, least);
  const auto cost = [&](const ValidatedChoice& one) { return 0.5 * independent * std::log(one.of_blocks + floor) - log_prior(laws, one.choice); };
  return *std::min_element(candidates.begin(), candidates.end(), [&](const ValidatedChoice& a, const ValidatedChoice& b) { return cost(a) < cost(b); });
}

// The model of all laws that are likelier there than not, which of all single models predicts best (Barbieri, Berger 2004, Annals of Statistics
// 32, p. 870); the likeliest where that is no candidate, or one that is much less likely (of two laws that are indistinguishable in these records each is
// half likely). `known`: probability of all candidates together.
std::size_t median_model(const std::vector<ValidatedChoice>& candidates, const std::vector<double>& probability, const std::vector<double>& inclusion, double known) {
  std::vector<int> likely;
  for (std::size_t l = 0; l < inclusion.size(); ++l) {
    if (inclusion[l] > 0.5 * known) likely.push_back(static_cast<int>(l));
  }
  const auto likeliest = static_cast<std::size_t>(std::max_element(probability.begin(), probability.end()) - probability.begin());
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const auto& chosen = candidates[k].choice.laws;
    const bool is_median = std::equal(chosen.begin(), chosen.end(), likely.begin(), likely.end(), [](const auto& law, int name) { return law.first == name; });
    if (is_median && probability[k] > kMedianShare * probability[likeliest]) return k;
  }
  return likeliest;
}

}  // namespace

double log_odds(const LeftOutError& one, const LeftOutError& other, double floor) {
  const auto ratio = [floor](double a, double b) { return std::log((std::max(0.0, a) + floor) / (std::max(0.0, b) + floor)); };
  const auto count = static_cast<double>(one.block_error.size());
  const bool has_records = !one.record_block_error.empty() && !other.record_block_error.empty();
  double mean = 0.0, square = 0.0;
  for (std::size_t b = 0; b < one.block_error.size(); ++b) {
    double more = ratio(one.block_error[b], other.block_error[b]);
    if (has_records) more = 0.5 * (more + ratio(one.record_block_error[b], other.record_block_error[b]));
    mean += more / count;
    square += more * more / count;
  }
  const double freedom = std::max(1.0, count - 1.0), variance = std::max(0.0, square - mean * mean) / freedom + kRatioDeviation * kRatioDeviation;
  return -std::copysign(0.5 * (freedom + 1.0) * std::log1p(mean * mean / variance / freedom), mean);
}

SetProbabilities set_probabilities(const std::vector<ValidatedChoice>& candidates, const std::vector<BalanceLaw>& laws, const Regression& regression,
                                   const ValidatedChoice& alone, const LeftOutError& unknown) {
  const double floor = kLeastShare * alone.of_blocks;
  const ValidatedChoice& reference = reference_of(candidates, laws, regression, floor);
  std::vector<double> odds;  // ln
  for (const ValidatedChoice& one : candidates) odds.push_back(log_odds(one, reference, floor) + log_prior(laws, one.choice));
  const double odds_unknown = std::log(kUnknownPrior) + log_prior(laws, reference.choice) + log_odds(unknown, reference, kRestShare * alone.of_blocks);
  const double top_odds = std::max(odds_unknown, *std::max_element(odds.begin(), odds.end()));
  double sum = std::exp(odds_unknown - top_odds);
  for (const double one : odds) sum += std::exp(one - top_odds);
  SetProbabilities found{{}, std::vector<double>(laws.size(), 0.0), std::exp(odds_unknown - top_odds) / sum, 0};
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    found.probability.push_back(std::exp(odds[k] - top_odds) / sum);
    for (const auto& [law, shape] : candidates[k].choice.laws) found.inclusion[static_cast<std::size_t>(law)] += found.probability.back();
  }
  found.answer = median_model(candidates, found.probability, found.inclusion, 1.0 - found.unknown);
  return found;
}

}  // namespace slewlab::diagnosis
