// From how well each hypothesis fits to how probable it is.
//
// The size of what a good model still misses is not known beforehand, only its usual size. With it integrated
// out, a hypothesis that leaves the mean square m of the whitened differences has the marginal likelihood of a
// Student distribution, (m_0 + m)^(-nu/2), with nu the number of independent differences in the records.
// A cause that is in no catalogue is a hypothesis too: it would leave a usual share of the gap.
#pragma once

#include <string>
#include <vector>

namespace slewlab::diagnosis {

struct EvidenceSettings {
  double independent_differences = 600.0;  // nu: learned on tuning seeds, docs/diagnosis.md
  double usual_mean_square = 0.2;         // m_0 of machines with nothing missing
  double unknown_share = 0.12;            // of the gap that a cause outside the catalogue leaves unexplained
  double unknown_floor = 3.0;             // [-] mean square below which nothing needs an unknown cause
  double prior_nothing = 0.5;
  double prior_single = 0.3;
  double prior_pair = 0.1;
  double prior_unknown = 0.1;
};

struct Candidate {
  std::vector<std::string> effects;  // none: nothing missing but parameters
  double mean_square = 0.0;          // cost / nu of its fit, priors included
};

struct Probabilities {
  std::vector<double> candidate;  // in the order of the candidates
  double unknown = 0.0;
};

// `candidates` holds exactly one without effects. `single_count` effects could have been named, so many share
// the prior of a single cause, and all pairs of them that of a pair.
Probabilities weigh(const std::vector<Candidate>& candidates, int single_count, const EvidenceSettings& settings);

}  // namespace slewlab::diagnosis
