// Candidates in which a stochastic effect (stochastic.h) has a part. First beside the fits without it: that of parameters alone and those of single
// effects. A delay is what jitter and loss do on the average, so beside a fitted delay they are named alone. The power comes from draws of its own at
// the fitted size. Then, beside the best of these alone, a second effect is looked for with the whole catalogue, all differences divided by what the
// effect adds to them; where each of these fits stands, the power is drawn anew. That is done too where no power is near yet and the residuals of all
// fits are large: the second effect may be what is too much for the stochastic one.
#pragma once

#include <vector>

#include "diagnosis/fit.h"
#include "diagnosis/screen.h"

namespace slewlab::diagnosis {

// One fit at most per set of effects, and only where the power comes near what a free one reaches and no fit without it has a smaller residual than
// that; of gusts only where a free power along the axes of every other screened effect costs more. Their differences and columns are the divided
// ones, the stochastic effect comes first. `fits` are concluded.
std::vector<FitResult> stochastic_fits(Problem& problem, const Screening& screening, const FitResult& nothing,
                                   const std::vector<FitResult>& fits, const Progress& tell);

}  // namespace slewlab::diagnosis
