// Causes with their probabilities, as an answer ranks them, and how probability goes from one to another.
#pragma once

#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "diagnosis/cause.h"
#include "diagnosis/controller_fit.h"

namespace slewlab::diagnosis {

// Causes with the probability that none of them is it.
struct Ranking {
  std::vector<Cause> causes;
  double unknown = 0.0;
};

// By falling probability; groups name only causes that are still there.
void sort_causes(std::vector<Cause>& causes);

// The cause without effects; null where there is none.
Cause* nothing_missing(Ranking& ranking);

// Takes a share of a cause's probability. It goes to nothing missing where the residual of the machine without the cause is noise alone
// (`is_nothing_left`), else to what is not known.
void take_away(double share, bool is_nothing_left, Cause& cause, Ranking& ranking);

// A share of a cause's probability goes to the others that have its effects but for those doubted, by their own probabilities; where there are
// none, as take_away() does. None gets any that was asked to predict and did not.
void hand_on(double share, const std::function<bool(const std::string&)>& is_doubted, bool is_nothing_left, Cause& cause, Ranking& ranking);

// Indistinguishable causes become one, with the probability of all of them. `same_as` has the effects that move a machine as another one does, and which.
void merge_same_motion(const std::map<std::string, std::string>& same_as, Ranking& ranking);

// Coarse counts are seen in the positions themselves, to the count: they need no fit, and every cause gets them beside what it has.
// Gives the count [rad]; 0 where none is coarse, or the nominal machine has them.
double add_counts(const Problem& problem, std::span<const std::string> without, Ranking& ranking);

// The controller answers otherwise than its settings say, so every cause needs one of its effects beside what the machine's side needs.
// `catalogue` is the controller's.
void add_controller_causes(const common::EffectCatalogue& catalogue, const std::vector<ControllerCause>& parts, Ranking& ranking);

}  // namespace slewlab::diagnosis
