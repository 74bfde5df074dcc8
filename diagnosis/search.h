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
  bool is_judged_elsewhere = false;  // the records are, and the search is to begin anew
  std::map<std::string, std::string> same_as;  // effects that move this machine as another one does, under whose name they were fitted
};
// What the best single fit shows, with which it is asked: that the problem's nominal machine has been built otherwise, or that the records are judged elsewhere, so that nothing holds that was found.
enum class Shown { nothing, built_otherwise, judged_elsewhere };
using Shows = std::function<Shown(FitResult&)>;

// `base` goes on where the nominal machine changes; where the records are judged elsewhere the search ends there.
Found search(Problem& problem, FitResult& base, const Screening& screening, const SearchSettings& settings, const Shows& shows,
             const Progress& tell);

}  // namespace slewlab::diagnosis
