// Which sets of laws are judged as answers, of the too many that there are: no law, each alone, each pair, and what grows from the ordinary laws,
// from none and from the best pairs one law at a time while validation improves; beside what has grown, that with one law less and with one law
// in another's place. Each set of laws once, in the shapes that validate best.
//
// At most kMostTerms laws beside the inertia. Source: forward selection with deletion, Miller 2002, Subset Selection in Regression, ch. 3.
#pragma once

#include <cstddef>
#include <vector>

#include "diagnosis/balance/balance_validation.h"

namespace slewlab::diagnosis {

LawChoice without_law(LawChoice choice, std::size_t index);

// `alone`: the inertia alone. In the order of their laws.
std::vector<ValidatedChoice> candidates_of(const Regression& regression, const std::vector<BalanceLaw>& laws, const ValidatedChoice& alone);

}  // namespace slewlab::diagnosis
