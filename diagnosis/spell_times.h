// When a law that lasts for a spell (common/effect.h) begins and ends. Its ramps strike the structure, so the cost has a valley for every period of the lowest mode in which a ramp lies, and a
// descent leaves none. What the law takes away at other times is seen by one simulation each, parameters and the law's size linearly (screen.h):
//   all over the records on the nominal machine, at a few sizes, with ramps too slow to strike: a large one is far from linear, so that columns of small ones do not find it;
//   on a fit's machine without the law the beginning moved by up to some periods with the end as it is, and the end with the beginning as it is, each with the law's details as they are and
//   at either end of their usual range.
#pragma once

#include <vector>

#include "common/effect.h"
#include "diagnosis/fit.h"
#include "diagnosis/problem.h"

namespace slewlab::diagnosis {

// The effect all over a record of `record_time` [s]: from the end of each of its parts to that of each later one, at a few sizes of either sign, its details at the
// upper end of their usual range.
std::vector<common::EffectInstance> all_times(const common::EffectAbout& about, double record_time);

// The effect at those other times, by steps of a machine's characteristic time [s]; within its bounds.
std::vector<common::EffectInstance> other_times(const common::EffectAbout& about, const common::EffectInstance& effect, double time);

// Fits from the times that promise most, the other effects from where they are, first as if the noise's size were not known (settle_from_afar()), and takes what is cheaper: again from
// there while it comes on by much. Nothing changes where no effect of the fit lasts for a spell; of two that do the first one is looked for.
void look_for_other_times(Problem& problem, FitResult& fitted);

}  // namespace slewlab::diagnosis
