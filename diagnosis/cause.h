// Causes as a person reads them: effects with their sizes, and which other causes the records cannot tell from them.
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "diagnosis/controller_fit.h"
#include "diagnosis/fit.h"
#include "diagnosis/screen.h"
#include "diagnosis/validate.h"

namespace slewlab::diagnosis {

struct Size {
  std::string parameter;
  std::string unit;
  double value = 0.0;
  double deviation = 0.0;  // one standard deviation
  double low = 0.0, high = 0.0;  // 90 % interval
};

// Another cause that the records cannot tell from one.
struct Alike {
  std::string name;
  double apart = 0.0;  // share of the one's signature by which this one's differs
};

struct Cause {
  std::vector<std::string> effects;   // one or two; none: only parameters are off
  double probability = 0.0;
  double with_unknown_law = 0.0;      // share of it that is of the effect with a law beside it that is in no catalogue (unknown_law.h)
  double explained = 0.0;             // share of the gap, down to what the best of all fits leaves
  double mean_square = 0.0;
  double excess = 0.0, prior = 0.0;    // as in evidence.h
  Eigen::VectorXd information;         // as in evidence.h
  double prior_chance = 1.0;           // that machines of one make lie so far from their nominal values
  Ending ending = Ending::settled;     // why its fit ended
  std::vector<Size> sizes;            // of all effects' parameters
  Point point;                                              // the machine's part
  std::vector<common::EffectInstance> controller_effects;  // the controller's part
  std::vector<Alike> group;
  std::vector<std::vector<std::string>> also;  // effects that move the machine just as its own do: one answer
  std::optional<Validation> validation;  // nothing where it was not asked for, or its sizes do not come from a fit
};

// "a", "a with b" or "only parameters are off".
std::string name_of(const std::vector<std::string>& effects);
std::string name_of(const Cause& cause);
// The same with what else it may be called: "a or b".
std::string told_name(const Cause& cause);

// `catalogue` has the effects in the machine's units.
Cause make_cause(const common::EffectCatalogue& catalogue, const FitResult& result);

// Causes whose signatures, as fitted, cannot be told apart: single ones by all that they do, pairs that share an effect by what
// the other one does beside it. Probabilities and causes stand in the order of the fits.
void find_groups(const Problem& problem, const FitResult& base, const Projector& project, const std::vector<FitResult>& fits,
                 std::span<const double> probability, std::span<Cause> causes);

// Causes with the probability that none of them is it.
struct Ranking {
  std::vector<Cause> causes;
  double unknown = 0.0;
};

// Causes that are one motion become one, with the probability of all of them. `same_as` has the effects that move a machine as another one does, and which.
void merge_same_motion(const std::map<std::string, std::string>& same_as, Ranking& ranking);

// Coarse counts are seen in the positions themselves, to the count: they need no fit, and every cause gets them beside what it has.
// Gives the count [rad]; 0 where none is coarse, or the nominal machine has them.
double add_counts(const Problem& problem, std::span<const std::string> without, Ranking& ranking);

// The controller answers otherwise than its settings say, so every cause needs one of its effects beside what the machine's side needs.
// `catalogue` is the controller's.
void add_controller_causes(const common::EffectCatalogue& catalogue, const std::vector<ControllerCause>& parts, Ranking& ranking);

}  // namespace slewlab::diagnosis
