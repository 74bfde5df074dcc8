// When a law that lasts for a spell (common/effect.h) begins and ends. Its ramps strike the structure, so the cost has a valley for every period of the lowest mode in which a ramp lies, and a
// descent leaves none. On the fit's machine without the law what it takes away at other times is seen by one simulation each, parameters and the law's size linearly (screen.h): the
// beginning moved by up to a few periods with the end as it is, and the end with the beginning as it is, each with the law's details as they are and at either end of their usual range.
#pragma once

#include <vector>

#include "common/effect.h"
#include "diagnosis/fit.h"
#include "diagnosis/problem.h"

namespace slewlab::diagnosis {

// The effect, which lasts for a spell, at those other times, `time_step` [s] apart; within its bounds.
std::vector<common::EffectInstance> other_times(const common::EffectAbout& about, const common::EffectInstance& effect, double time_step);

// Fits from the times that promise most, the other effects from where they are, until that settles, and takes what is cheaper: again from there while it comes on by
// much. Nothing changes where no effect of the fit lasts for a spell; of two that do the first one is looked for.
void look_for_other_times(Problem& problem, FitResult& fitted);

}  // namespace slewlab::diagnosis
