// From fits to causes with probabilities. Every fit is a hypothesis (evidence.h), weighed by its residual against the sensors' noise as its own
// machine has it (own_noise.h) and, where a controller answered, as its loop makes it (controller_loop.h). Beside them stand unknown laws
// (unknown_law.h): alone, beside the best single effect and beside those that lead together.
#pragma once

#include <cstddef>
#include <vector>

#include "diagnosis/cause.h"
#include "diagnosis/discrepancy.h"
#include "diagnosis/evidence.h"
#include "diagnosis/fit.h"
#include "diagnosis/search.h"

namespace slewlab::diagnosis {

// In the order of the fits, that without effects first.
struct Weighed {
  std::vector<Cause> causes;
  Probabilities probabilities;
  double least_mean_square = 0.0;  // of the differences, by a fit without a stochastic effect or an unknown law

  // The fit of the likeliest cause that has effects; nothing where an unknown one is likelier.
  const FitResult* answer(const std::vector<FitResult>& fits) const;
};

// Of the fits, by rising cost, those with one effect that is not stochastic: the best one, and those of the answer's effects (null where there is no answer). Beside them something is looked for
// that is no effect of the catalogue.
std::vector<std::size_t> fits_to_ask_beside(const common::EffectCatalogue& catalogue, const std::vector<FitResult>& fits, const FitResult* answer);

// `effect_count` effects could have been named. `is_controlled`: the commands are a controller's answers. Throws Interrupted.
Weighed weigh_fits(Problem& problem, const Found& found, const SmoothTorques& smooth, std::size_t effect_count, EvidenceSettings evidence, bool is_controlled);

}  // namespace slewlab::diagnosis
