// From how well each hypothesis fits to how probable it is.
//
//   ln P(hypothesis | records) = ln prior - (M(c) + p + sum(ln(1 + w lambda)) + c_e * laws) / (2 T) - ln 2 * at_bounds + constant
//   M(c) = k ln(1 + c / (k + r G)) + m ln(1 + c / (n + q G)),    w = s k / (k + r G + c)
//
// c is the residual power of the hypothesis above that of the best one whose parameters a machine can have (above what the noise explains, where even
// the best is larger). G is the gap: the residual power of parameters alone, counted the same way. The law of a real effect is never quite the
// catalogue's: for some effects the residual of the true cause is a usual share r of the gap, for most no more than n + q G. With the size of that
// mismatch integrated out, misfits count by their ratios. p is -2 ln of the prior where M + p is least (relax() in fit.h). The sum, over the
// eigenvalues lambda of what the records say of the parameters (fit.h), is Occam's factor: how much narrower they became. Of a shape that ends at its
// bound half of that width lies beyond it. A cause that is in no catalogue is a hypothesis too: its residual would be a usual, larger share of the
// gap, and its parameters, whichever they are, would be as narrow as those of the single cause that fits best. T tempers it all: the errors of mesh,
// step and law are not independent from bin to bin.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace slewlab::diagnosis {

struct EvidenceSettings {
  double law_freedom = 50.0;     // k: learned on tuning seeds, docs/diagnosis/method.md, as are all below
  double law_share = 0.002;      // r
  double near_freedom = 20.0;    // m
  double near_misfit = 100.0;    // n
  double near_share = 0.0002;    // q
  double unknown_share = 0.15;   // residual of a cause outside the catalogue, as a share of the gap
  double unknown_floor = 100.0;  // [-] c of such a cause, at least
  double unknown_prior = 17.0;   // p of its parameters: what the nuisances of a machine have on the average
  double temper = 1.5;           // T
  double independent_share = 0.3;  // s, as in fit.h
  double discrepancy_count = 2.0;  // m, by which mesh and step count in own_noise.h
  double effect_cost = 12.0;     // c_e: what mesh, step and another simulator's laws let one more take away where nothing more is missing
  double prior_nothing = 0.4;
  double prior_single = 0.24;
  double prior_pair = 0.28;
  double prior_unknown = 0.08;
};

// M and dM/dc of a gap.
class MisfitCost {
 public:
  MisfitCost(const EvidenceSettings& settings, double gap);
  double operator()(double left) const;
  double slope(double left) const;
  double law_slope(double left) const;  // of the first term alone

 private:
  double law_freedom_, usual_, near_freedom_, near_misfit_;
};

struct Candidate {
  std::vector<std::string> effects;  // none: nothing missing but parameters
  double residual_power = 0.0;
  double prior = 0.0;
  Eigen::VectorXd information{};
  int at_bounds = 0;  // how many shapes of its effects ended there, their sizes aside
  // Laws that it holds: of an effect that others are together, where it has nothing of its own, these as well.
  std::size_t laws = effects.size();
  // As likely as a single effect: two that a law of the catalogue is together belong together.
  bool is_one_cause = effects.size() == 1;
  std::optional<double> chance{};  // of it before the records, where it is none of the catalogue's alone: an unknown law, alone or beside an effect
};

struct Probabilities {
  std::vector<double> candidate;  // in the order of the candidates
  double unknown = 0.0;
  double unknown_law = 0.0;  // of it that of laws that were fitted (unknown_law.h)
  double floor = 0.0;  // the residual power from which c counts
};

// `candidates` holds exactly one without effects. `single_count` effects could have been named, so many share
// the prior of a single cause, and all pairs of them that of a pair.
Probabilities weigh(const std::vector<Candidate>& candidates, int single_count, const EvidenceSettings& settings);

// The chance that machines as the file describes them lie as far from their nominal values as p says, or further: p is the sum of the squares of those
// parameters that the records determine, N = sum(s lambda / (1 + s lambda)) of them, hence chi squared of N degrees of freedom (by Wilson and Hilferty's normal
// approximation, Proc. Natl. Acad. Sci. 17, 1931, within 0.001 from N = 3 on). 1 where the records determine less than one.
inline constexpr double kFarTogether = 0.01;  // chance below which something else may hide in the parameters: one machine in a hundred
double chance_of_prior(double prior, const Eigen::VectorXd& information, double independent_share);

// Whether the residual of a machine is a measure for others: not where its parameters are such as no machine has (chance below one in a million), for
// they fit the noise.
bool is_a_measure(double prior, const Eigen::VectorXd& information, double independent_share);

}  // namespace slewlab::diagnosis
