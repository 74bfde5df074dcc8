// The search on the machine as its records show it to be built, and on the parts of them that remain to be judged.
//
// The nominal machine of a problem is not always the right one to search on. A log that slewlab itself made has the boom cut as its file says. Large
// swings show what every machine does and a linear model leaves out. A record that begins on a machine that has moved begins as nobody knows. Each is
// taken where a fit shows it, and the search goes on from there. A cause may have impacts of its own; near these nothing is judged then. Where the
// residual of a machine is far smaller than the assumed errors of mesh and step, it is taken for their size.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/fit.h"
#include "diagnosis/progress.h"
#include "diagnosis/screen.h"
#include "diagnosis/search.h"
#include "diagnosis/whitening.h"

namespace slewlab::diagnosis {

struct Searched {
  FitResult base;  // parameters alone
  Screening screening;
  Found found;
  FitResult nominal_machine;  // with nothing fitted but how its records begin, and that only where its residual then is no more than noise
  std::vector<common::EffectInstance> of_every_machine;  // what every machine does, where the records show it

  // Of parameters alone and the fits without stochastic effects.
  const FitResult& best(const common::EffectCatalogue& catalogue) const;
};

// The search on an admitted problem. `whitening` are the settings by which its records are judged. Problem and settings are left as the search ended
// on them: the nominal machine as it is built, the records as they are judged. Effects that are left out are neither looked for nor taken for what
// every machine does. What is done to the records is told in `remarks`. Throws Interrupted.
Searched search_as_built(Problem& problem, WhiteningSettings& whitening, const std::vector<std::string>& without, const SearchSettings& settings, std::vector<std::string>& remarks,
                         const Progress& tell);

}  // namespace slewlab::diagnosis
