#include "diagnosis/evidence.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

namespace slewlab::diagnosis {

MisfitCost::MisfitCost(const EvidenceSettings& settings, double gap)
    : law_freedom_(settings.law_freedom),
      usual_(settings.law_freedom + settings.law_share * gap),
      near_freedom_(settings.near_freedom),
      near_misfit_(settings.near_misfit + settings.near_share * gap) {}

double MisfitCost::operator()(double left) const {
  return law_freedom_ * std::log1p(left / usual_) + near_freedom_ * std::log1p(left / near_misfit_);
}

double MisfitCost::law_slope(double left) const { return law_freedom_ / (usual_ + left); }

double MisfitCost::slope(double left) const { return law_slope(left) + near_freedom_ / (near_misfit_ + left); }

namespace {

constexpr double kNever = 1e-6;  // chance of a machine

// The cause of one effect with the smallest residual; nothing missing where there is none.
const Candidate& best_single(const std::vector<Candidate>& candidates) {
  const auto rank = [](const Candidate& candidate) {
    return std::pair(candidate.chance ? 3 : candidate.effects.size() == 1 ? 0 : candidate.effects.empty() ? 1 : 2, candidate.residual_power);
  };
  return *std::min_element(candidates.begin(), candidates.end(), [&](const Candidate& a, const Candidate& b) { return rank(a) < rank(b); });
}

}  // namespace

Probabilities weigh(const std::vector<Candidate>& candidates, int single_count, const EvidenceSettings& settings) {
  const Candidate* nothing = nullptr;
  for (const Candidate& candidate : candidates) {
    if (candidate.effects.empty() && !candidate.chance) nothing = &candidate;
  }
  if (nothing == nullptr) throw std::invalid_argument("no candidate stands for nothing missing");
  double floor = 0.0;
  for (const Candidate& candidate : candidates) {
    if (is_a_measure(candidate.prior, candidate.information, settings.independent_share)) floor = std::min(floor, candidate.residual_power);
  }
  const double gap = nothing->residual_power - floor;
  const MisfitCost misfit_cost(settings, gap);
  const auto likelihood = [&](double left, const Candidate& candidate, std::size_t laws) {
    const double weight = settings.independent_share * misfit_cost.law_slope(left);
    const double occam = (1.0 + weight * candidate.information.array()).log().sum();
    return -0.5 / settings.temper * (misfit_cost(left) + candidate.prior + occam + settings.effect_cost * static_cast<double>(laws));
  };
  const double singles = std::max(1, single_count);
  std::vector<double> score;
  for (const Candidate& candidate : candidates) {
    const double prior = candidate.chance            ? *candidate.chance
                         : candidate.effects.empty() ? settings.prior_nothing
                         : candidate.is_one_cause    ? settings.prior_single / singles
                                                     : settings.prior_pair / (singles * (singles - 1.0) / 2.0);
    score.push_back(std::log(prior) - std::numbers::ln2 * candidate.at_bounds + likelihood(std::max(0.0, candidate.residual_power - floor), candidate, candidate.laws));
  }
  const double unexplained = std::max(settings.unknown_floor, settings.unknown_share * gap);
  Candidate outside = best_single(candidates);
  outside.prior = settings.unknown_prior;
  const double unknown = std::log(settings.prior_unknown) + likelihood(unexplained, outside, 1);
  const double top = std::max(unknown, *std::max_element(score.begin(), score.end()));
  Probabilities result;
  result.floor = floor;
  double sum = std::exp(unknown - top);
  for (const double value : score) sum += std::exp(value - top);
  for (const double value : score) result.candidate.push_back(std::exp(value - top) / sum);
  result.unknown = std::exp(unknown - top) / sum;
  return result;
}

double chance_of_prior(double prior, const Eigen::VectorXd& information, double independent_share) {
  const Eigen::ArrayXd weighed = independent_share * information.array();
  const double determined = (weighed / (1.0 + weighed)).sum();
  if (determined < 1.0) return 1.0;
  const double variance = 2.0 / (9.0 * determined);  // of the cube root of p / N, about 1 - variance
  return 0.5 * std::erfc((std::cbrt(std::max(0.0, prior) / determined) - (1.0 - variance)) / std::sqrt(2.0 * variance));
}

bool is_a_measure(double prior, const Eigen::VectorXd& information, double independent_share) {
  return chance_of_prior(prior, information, independent_share) >= kNever;
}

}  // namespace slewlab::diagnosis
