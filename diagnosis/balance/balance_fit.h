// Which laws close the torque balance of an axis, decided by data that were not fitted.
//
//   F - (nominal load) = J q'' + sum over laws of size * law(q', q, t)                                (1)
//
// Sizes by linear least squares; shapes (a Stribeck speed, a warming time, a lag) from a grid. The data's way, a module each:
//
//   balance_record.h       positions and efforts under one filter
//   balance_setup.h        the window, the speed from which friction is judged, the laws in the axis's units
//   balance_laws.h         the laws
//   balance_regression.h   their columns and sums; balance_priors.h: what is known without records
//   balance_validation.h   a set of laws, judged by blocks and records that were left out
//   balance_search.h       which sets are judged
//   balance_probability.h  how probable each is, and which is the answer; balance_unknown.h: what no law explains
//   balance_sizes.h        the sizes that are stated, and those that predict
//   balance_model.h        what a model is, and its residual on a record
//
// The answer is the model of the laws that are likelier there than not. All sizes are in units of the axis; every threshold is a share of the
// record's own or the machine's scales.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/balance/balance_model.h"

namespace slewlab::diagnosis {

struct LawProbability {
  std::string law, words;
  LawFamily family = LawFamily::friction;
  double probability = 0.0;  // that it is there, alone or beside any others
  double belief = 1.0;       // share of the probability that the residual does not take away: something unknown may be what the law was fitted to
};

struct BalanceAnswer {
  double nominal = 0.0;              // mean square of the residual with the nominal inertia
  double parameters = 0.0;           // validation with the inertia alone
  BalanceModel best;
  std::vector<BalanceModel> models;  // falling probability; the first is best, its sizes as they are stated
  double probability_unknown = 0.0;
  double explained = 0.0;            // share of the gap that the best model explains on left-out data
  Remainder remainder;
  double independent_count = 0.0;    // N
  double judged_share = 0.0;         // of all samples
  std::vector<LawProbability> laws;  // of all that were tried
};

// That any law of a family is there: what may be sure where the members are not. A model of doubted laws has the family unless none of them is there,
//
//   P = sum over models of p (1 - product over its laws of the family of (1 - belief))                 (2)
struct FamilyProbability {
  LawFamily family = LawFamily::friction;
  double probability = 0.0;
};
std::vector<FamilyProbability> family_probabilities(const BalanceAnswer& answer);
// Of a model, what of its probability doubts of its laws do not take away: p times the beliefs of them. The rest is that of its other laws with something
// unknown in the place of those.
double believed_probability(const BalanceAnswer& answer, const BalanceModel& model);
// Falling, the answer's own laws as its terms say.
std::vector<LawProbability> law_probabilities(const BalanceAnswer& answer);

// Throws std::invalid_argument where the records do not move enough for a balance.
BalanceAnswer fit_balance(const std::vector<BalanceRecord>& records, const std::vector<BalanceLaw>& laws, double nominal_inertia,
                          double resolved_speed);

}  // namespace slewlab::diagnosis
