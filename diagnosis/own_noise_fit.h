// Fits whose machine makes something else of the sensors' noise than the nominal one does, fitted by that noise.
//
// Differences are divided by what the noise is in the nominal machine (whitening.h). Where a fit's own machine makes more of it, the fit bends parameters and
// shapes to make less: a house that twists shakes with the encoders' noise where a rigid one does not, and beside a residual that is noise a second cause seems to be
// missing that only takes noise away. So such a hypothesis is fitted by the noise of its own machine (own_noise.h), wherever that stands,
//
//   s (z* V(machine)^-1 z - n) + priors  as small as it can be
//
// from where the fit stands, and from the nominal parameters with its shapes where they are and off their centres: by the nominal machine's noise the other valleys cannot be seen.
// Not where the residual lies far above the noise of all these: what bends such a fit is not the noise.
#pragma once

#include <vector>

#include "diagnosis/fit.h"

namespace slewlab::diagnosis {

// Whether the machine at the point makes more or less of the noise than the nominal one, by more than noise is known.
bool makes_other_noise(const Problem& problem, const Point& point);

// For as long as it lives each point's differences are divided by the noise of its own machine, if so asked.
class UnderOwnNoise {
 public:
  UnderOwnNoise(Problem& problem, bool is_asked) : problem_(problem) { problem_.is_by_own_noise = is_asked; }
  ~UnderOwnNoise() { problem_.is_by_own_noise = false; }
  UnderOwnNoise(const UnderOwnNoise&) = delete;
  UnderOwnNoise& operator=(const UnderOwnNoise&) = delete;

 private:
  Problem& problem_;
};

// The cheapest fit that has no stochastic effect and, where it has several effects, those of each of them alone. They come back concluded, with cost, mean square and deviations by their own noise; differences and columns as the problem divides them.
void fit_by_own_noise(Problem& problem, std::vector<FitResult>& fits);

}  // namespace slewlab::diagnosis
