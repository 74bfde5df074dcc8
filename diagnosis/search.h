// From what the screening promises to fitted hypotheses: single effects, pairs, stochastic effects, and nothing missing.
#pragma once

#include <vector>

#include "diagnosis/fit.h"
#include "diagnosis/screen.h"

namespace slewlab::diagnosis {

struct SearchSettings {
  int singles_to_refine = 14;  // starts, two of an effect at most
  int contenders = 5;          // of the refined ones, with another round
  int leaders = 3;             // of these, the best with fresh columns until it settles
  int joint_pairs = 4;         // tried for what two signatures do jointly; 0: no pairs at all
  int beside_the_best = 5;     // of them at most beside the best single effect
  int pair_contenders = 3;
  int pair_leaders = 2;
};

struct Found {
  FitResult nothing;            // parameters alone
  std::vector<FitResult> fits;  // of one or two effects
};
Found search(Problem& problem, const FitResult& base, const Screening& screening, const SearchSettings& settings,
             const Progress& tell);

}  // namespace slewlab::diagnosis
