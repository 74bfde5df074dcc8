#include "diagnosis/evidence.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace slewlab::diagnosis {

Probabilities weigh(const std::vector<Candidate>& candidates, int single_count, const EvidenceSettings& settings) {
  double gap = -1.0;
  for (const Candidate& candidate : candidates) {
    if (candidate.effects.empty()) gap = candidate.mean_square;
  }
  if (gap < 0.0) throw std::invalid_argument("no candidate stands for nothing missing");
  const auto likelihood = [&](double mean_square) {
    return -0.5 * settings.independent_differences * std::log(settings.usual_mean_square + mean_square);
  };
  const double singles = std::max(1, single_count);
  std::vector<double> score;
  for (const Candidate& candidate : candidates) {
    const double prior = candidate.effects.empty()       ? settings.prior_nothing
                         : candidate.effects.size() == 1 ? settings.prior_single / singles
                                                         : settings.prior_pair / (singles * (singles - 1.0) / 2.0);
    score.push_back(std::log(prior) + likelihood(candidate.mean_square));
  }
  const double unexplained = std::max(settings.unknown_floor, settings.unknown_share * gap);
  const double unknown = std::log(settings.prior_unknown) + likelihood(unexplained);
  const double top = std::max(unknown, *std::max_element(score.begin(), score.end()));
  Probabilities result;
  double sum = std::exp(unknown - top);
  for (const double value : score) sum += std::exp(value - top);
  for (const double value : score) result.candidate.push_back(std::exp(value - top) / sum);
  result.unknown = std::exp(unknown - top) / sum;
  return result;
}

}  // namespace slewlab::diagnosis
