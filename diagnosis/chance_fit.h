// Candidates in which an effect by chance (chance.h) has a part, from fits without it: beside the fit of parameters alone, and beside that
// of each single effect. A delay is the mean of such an effect, so beside a fitted delay it is named alone. The power comes from
// draws of its own at the fitted size, delays and parameters taken out.
#pragma once

#include <vector>

#include "diagnosis/fit.h"
#include "diagnosis/screen.h"

namespace slewlab::diagnosis {

// One fit at most per effect by chance and per set of effects beside it, and only where its power comes near what a free one reaches
// and no fit without chance leaves less than that. Their differences and columns are those divided by the standard deviation that
// the chance gives them. `fits` are concluded.
std::vector<FitResult> chance_fits(Problem& problem, const Base& base, const Screening& screening,
                                   const FitResult& nothing, const std::vector<FitResult>& fits);

}  // namespace slewlab::diagnosis
