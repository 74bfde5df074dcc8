// From what the screening promises to fitted hypotheses: single effects, pairs, stochastic effects, and nothing missing.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "diagnosis/fit.h"
#include "diagnosis/screen.h"

namespace slewlab::diagnosis {

struct SearchSettings {
  int singles_to_refine = 14;  // starts, two of an effect at most
  int contenders = 6;          // of the refined ones, that converge
  int joint_pairs = 4;         // tried for what two signatures do jointly; 0: no pairs at all
  int beside_the_best = 5;     // of them at most beside the best single effect
  int pair_contenders = 4;
};

struct Found {
  FitResult nothing;            // parameters alone
  std::vector<FitResult> fits;  // of one or two effects
  std::map<std::string, std::string> same_as;  // effects that move this machine as another one does, under whose name they were fitted
};
// Asked with the best single fit: whether the problem's nominal machine has been built otherwise, because that fit shows it.
using TakesMore = std::function<bool(FitResult&)>;

// `base` goes on where the nominal machine changes.
Found search(Problem& problem, FitResult& base, const Screening& screening, const SearchSettings& settings, const TakesMore& takes_more,
             const Progress& tell);

}  // namespace slewlab::diagnosis
